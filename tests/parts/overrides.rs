//! Material changes in extras affect the light of that instance only, and no form factors.

use equilux_assemble::report::Report;
use equilux_bake::gltf_import::import_scene;
use equilux_bake::oven::prepare::Division;
use equilux_formats::{LocalSolver, Material, Rgb};
use equilux_tests::model::{Model, Node};
use equilux_tests::rooms::{lamp, paint};
use equilux_tests::shapes::{joined, room, solid};
use equilux_tests::workshop::{Workshop, assembled};
use glam::{DVec3, dvec3};
use serde_json::{Value, json};
use std::f64::consts::PI;

/// A lamp with a shade that reflects.
fn lantern(shade: Material, light: Material) -> equilux_formats::Part {
    joined([
        solid(Material { name: "shade".into(), ..shade }, DVec3::ZERO, dvec3(0.5, 0.25, 0.5)),
        solid(light, dvec3(0.0, 0.5, 0.0), DVec3::splat(0.75)),
    ])
}

fn shade() -> Material {
    paint([0.5; 3])
}

fn light() -> Material {
    lamp([4.0, 3.0, 2.0])
}

/// Two lanterns in a room, the second with these extras.
fn scene(second: equilux_formats::Part, extras: Value) -> Vec<Node> {
    let walls = room(paint([0.6, 0.5, 0.7]), DVec3::ZERO, dvec3(4.0, 3.0, 3.0));
    let mut second = Node::new("second", second);
    (second.at, second.extras) = (dvec3(2.5, 1.0, 1.5), extras);
    let mut first = Node::new("first", lantern(shade(), light()));
    first.at = dvec3(0.5, 0.5, 0.5);
    vec![Node::new("walls", walls), first, second]
}

/// Report and radiosities of all elements.
fn lit(workshop: &Workshop, nodes: &[Node], solver: LocalSolver) -> (Report, Vec<f64>) {
    Model::of(nodes).write(&workshop.path("scene.glb"));
    let table = workshop.path("table.csv");
    let mut job = workshop.job(Division::Authored);
    job.outputs.elements = Some(table.clone());
    job.settings.preparation.local_solver = Some(solver);
    let report = assembled(&job);
    let text = std::fs::read_to_string(table).expect("the table");
    let radiosity = |line: &str| {
        line.split(',').skip(16).take(3).map(|n| n.parse().expect("a number")).collect::<Vec<f64>>()
    };
    (report, text.lines().skip(1).flat_map(radiosity).collect())
}

fn plain() -> Vec<Node> {
    scene(lantern(shade(), light()), json!({}))
}

#[test]
fn a_repainted_instance_costs_no_form_factor_and_shines_as_a_repainted_copy() {
    for (extras, shade, light) in [
        (
            json!({ "materials": { "shade": { "baseColorFactor": [0.875, 0.125, 0.25, 1] } } }),
            paint([0.875, 0.125, 0.25]),
            light(),
        ),
        (
            json!({ "materials": { "lamp": { "emissiveFactor": [0.25, 0.5, 1], "emissiveStrength": 8 } } }),
            shade(),
            lamp([2.0 * PI, 4.0 * PI, 8.0 * PI]),
        ),
        (json!({ "materials": { "lamp": { "emissiveStrength": 0 } } }), shade(), lamp([0.0; 3])),
        (
            json!({ "emission_scale": 0.5, "materials": {
                "lamp": { "emissiveFactor": [1, 1, 1], "emissiveStrength": 3 },
                "shade": { "baseColorFactor": [0, 0.5, 0.25, 1], "emissiveFactor": [0, 0, 1] },
            } }),
            Material { emission: Rgb([0.0, 0.0, PI / 2.0]), ..paint([0.0, 0.5, 0.25]) },
            lamp([1.5 * PI; 3]),
        ),
    ] {
        for solver in [LocalSolver::Direct, LocalSolver::GaussSeidel] {
            let (one, other) = (Workshop::new(), Workshop::new());
            lit(&one, &plain(), solver);
            let (report, found) =
                lit(&one, &scene(lantern(self::shade(), self::light()), extras.clone()), solver);
            assert_eq!(report.form_factors_computed, 0, "form factors computed for {extras}");
            assert_eq!(report.parts.len(), 2, "parts with {extras}");
            assert!(
                !report.notes.iter().any(|note| note.contains("repaint")),
                "{:?} with {extras}",
                report.notes
            );
            let (_, expected) = lit(&other, &scene(lantern(shade.clone(), light.clone()), json!({})), solver);
            assert_eq!(found.len(), expected.len());
            // Both are solved down to rounding, and no number here loses digits as f32.
            let brightest = expected.iter().copied().fold(0.0, f64::max);
            let off = found.iter().zip(&expected).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            assert!(off <= 1e-12 * brightest, "{extras}, {solver:?}: {off} of {brightest} W/m²");
        }
    }
}

#[test]
fn a_repaint_of_a_group_reaches_parts_below_and_the_nearest_one_decides() {
    let workshop = Workshop::new();
    Model::of(&[Node::new("lantern", lantern(shade(), light()))]).write(&workshop.path("lantern.glb"));
    let red = |red: f64| json!({ "shade": { "baseColorFactor": [red, 0, 0, 1] } });
    let mut model = Model::of(&[
        Node::of_file("outer", "lantern.glb"),
        Node::of_file("inner", "lantern.glb"),
        Node::of_file("group", ""),
        Node::of_file("elsewhere", "lantern.glb"),
    ]);
    model = model.with("/scenes/0/nodes", json!([2, 3]));
    model = model.with(
        "/nodes/2",
        json!({ "name": "group", "children": [0, 1], "extras": { "materials": red(0.5) } }),
    );
    model = model.with("/nodes/1/extras/materials", red(0.25));
    for node in [0, 1, 3] {
        model = model.with(&format!("/nodes/{node}/translation"), json!([0, 0, 9 * node]));
    }
    model.write(&workshop.path("scene.glb"));
    let scene = import_scene(&workshop.path("scene.glb")).expect("a scene");
    let reds: Vec<(&str, Option<f64>)> = scene
        .instances
        .iter()
        .map(|i| (i.name.as_str(), i.repainted.first().map(|repainted| repainted.reflectance[0])))
        .collect();
    assert_eq!(reds, [("elsewhere", None), ("inner", Some(0.25)), ("outer", Some(0.5))]);
    assert_eq!(scene.parts.len(), 1, "one part, however it is painted");
}

#[test]
fn a_repaint_below_a_root_is_worked_into_the_part() {
    let mut model = Model::of(&[
        Node::new("root", lantern(shade(), light())),
        Node::new("child", lantern(shade(), light())),
    ]);
    model = model.with("/scenes/0/nodes", json!([0])).with("/nodes/0/children", json!([1]));
    model = model.with("/nodes/1/translation", json!([2, 0, 0]));
    model = model
        .with("/nodes/1/extras", json!({ "materials": { "shade": { "baseColorFactor": [0, 0, 1, 1] } } }));
    let workshop = Workshop::new();
    model.write(&workshop.path("scene.glb"));
    let scene = import_scene(&workshop.path("scene.glb")).expect("a scene");
    let shades: Vec<Rgb> =
        scene.parts[0].materials.iter().filter(|m| m.name == "shade").map(|m| m.reflectance).collect();
    assert_eq!(shades, [Rgb::splat(0.5), Rgb([0.0, 0.0, 1.0])]);
}

#[test]
fn a_material_that_is_not_there_is_noted_and_nonsense_is_refused() {
    let noted = |materials: Value| {
        let workshop = Workshop::with(&scene(lantern(shade(), light()), json!({ "materials": materials })));
        import_scene(&workshop.path("scene.glb")).map(|scene| scene.notes).map_err(|error| error.to_string())
    };
    let notes = noted(json!({ "shade": {}, "chrome": { "emissiveStrength": 2 } })).expect("a scene");
    assert_eq!(notes, ["second: its extras repaint the material `chrome`, which nothing there has"]);
    for nonsense in [
        json!("red"),
        json!({ "shade": { "baseColorFactor": [1, 1, 1] } }),
        json!({ "shade": { "baseColorFactor": [2, 1, 1, 1] } }),
        json!({ "shade": { "emissiveStrength": -1 } }),
        json!({ "shade": { "colour": [1, 1, 1, 1] } }),
    ] {
        let error = noted(nonsense.clone()).expect_err("nonsense");
        assert!(error.contains("node second with materials"), "{nonsense}: {error}");
    }
}

#[test]
fn a_divided_scene_is_painted_as_its_instances_were() {
    let extras = json!({ "materials": { "shade": { "baseColorFactor": [0.875, 0.125, 0.25, 1] } } });
    let absorbed =
        |nodes: &[Node]| assembled(&Workshop::with(nodes).job(Division::Bisect(2))).energy.absorbed;
    let repainted = absorbed(&scene(lantern(shade(), light()), extras));
    let copied = absorbed(&scene(lantern(paint([0.875, 0.125, 0.25]), light()), json!({})));
    for (a, b) in repainted.into_iter().zip(copied) {
        // Both are solved down to rounding, and no number here loses digits as f32.
        assert!((a - b).abs() <= 1e-12 * b, "{a} and {b} W absorbed");
    }
}
