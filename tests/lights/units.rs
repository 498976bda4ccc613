//! Units of a file's lamps, and notes about them.

use super::floor;
use equilux_assemble::outputs::requests::Pictures;
use equilux_bake::oven::prepare::Division;
use equilux_formats::LightUnits;
use equilux_tests::model::{Model, Node};
use equilux_tests::shapes::{grey, part, rectangle};
use equilux_tests::table::Table;
use equilux_tests::workshop::{Workshop, assembled};
use glam::{DVec3, dvec3};
use serde_json::{Value, json};
use std::f64::consts::PI;

/// The floor and a lamp 2 m above it, in a file that `generator` wrote.
fn lit_floor(generator: Option<&str>, lamp: Value) -> Model {
    let mut model = Model::of(&[Node::new("floor", floor())]);
    model.json["asset"]["generator"] = json!(generator);
    model.json["extensions"] = json!({ "KHR_lights_punctual": { "lights": [lamp] } });
    let looking_down = json!([-0.5_f64.sqrt(), 0, 0, 0.5_f64.sqrt()]);
    let lamp = json!({ "name": "bulb", "translation": [0, 2, 0], "rotation": looking_down,
        "extensions": { "KHR_lights_punctual": { "light": 0 } } });
    model.json["nodes"].as_array_mut().expect("nodes").push(lamp);
    model.json["scenes"][0]["nodes"] = json!([0, 1]);
    model
}

/// The light that the floor absorbs, W, and the notes.
fn absorbed(workshop: &Workshop, units: Option<LightUnits>) -> (f64, Vec<String>) {
    let table = workshop.path("elements.csv");
    let mut job = workshop.job(Division::Authored);
    job.settings.light_units = units;
    job.outputs.pictures = Pictures::None;
    job.outputs.elements = Some(table.clone());
    let report = assembled(&job);
    let table = Table::read(&table);
    let power = (0..table.rows()).map(|row| table.number(row, "area") * table.number(row, "H_r")).sum();
    (power, report.notes)
}

const BLENDER_4_2: &str = "Khronos glTF Blender I/O v4.2.60";
const BLENDER_3_3: &str = "Khronos glTF Blender I/O v3.3.27";

/// Blender's lamp of 12 W and its sun of 3 W/m² as its exporter writes them in each of its ways: the same light if the units
/// are right. 683 lm/W and 4π sr.
#[test]
fn the_units_of_blenders_exporter_are_taken_and_said() {
    let (lamp, sun) = (12.0, 3.0);
    let candela = lamp / (4.0 * PI) * 683.0;
    for (generator, units, point, lux, note) in [
        (Some(BLENDER_4_2), None, candela, 683.0 * sun, Some("--light-units photometric")),
        (Some(BLENDER_3_3), None, lamp, sun, Some("--light-units blender-raw")),
        (Some(BLENDER_4_2), Some(LightUnits::BlenderRaw), lamp, sun, None),
        (Some(BLENDER_4_2), Some(LightUnits::Radiometric), lamp / (4.0 * PI), sun, None),
        (None, None, lamp / (4.0 * PI), sun, None),
        (None, Some(LightUnits::Photometric), candela, 683.0 * sun, None),
    ] {
        for (kind, intensity, expected) in [
            // What a lamp of an intensity of 1 W/sr sends to the floor: the solid angle of 4 × 4 m from 2 m above.
            ("point", point, lamp / (4.0 * PI) * 4.0 * super::corner(2.0, 2.0, 2.0)),
            ("directional", lux, sun * 16.0),
        ] {
            let workshop = Workshop::new();
            lit_floor(generator, json!({ "type": kind, "intensity": intensity }))
                .write(&workshop.path("scene.glb"));
            let (found, notes) = absorbed(&workshop, units);
            // Intensities and positions are f32 in the file.
            let what = format!("{generator:?}, {units:?}, {kind}");
            assert!((found / expected - 1.0).abs() < 1e-6, "{what}: {found} W, expected {expected}");
            let said: Vec<&String> = notes.iter().filter(|note| note.contains("--light-units")).collect();
            match note {
                None => assert!(said.is_empty(), "{what}: {said:?}"),
                Some(words) => assert!(said.len() == 1 && said[0].contains(words), "{what}: {said:?}"),
            }
        }
    }
}

/// Each file's lamps are in its own units.
#[test]
fn a_part_file_of_blender_stands_in_another_programs_scene() {
    let workshop = Workshop::new();
    let lamp = |intensity: f64| json!({ "type": "point", "intensity": intensity });
    lit_floor(Some(BLENDER_4_2), lamp(683.0)).write(&workshop.path("blender.glb"));
    let mut scene = lit_floor(None, lamp(1.0));
    scene.json["nodes"][0] = json!({ "name": "floor", "extras": { "part": "blender.glb" } });
    scene.write(&workshop.path("scene.glb"));
    let (found, _) = absorbed(&workshop, None);
    let expected = 2.0 * 4.0 * super::corner(2.0, 2.0, 2.0);
    assert!((found / expected - 1.0).abs() < 1e-6, "{found} W, expected {expected}");
}

#[test]
fn numbers_that_can_hardly_be_watts_are_pointed_out() {
    for (kind, intensity, expected) in [
        ("point", 5435.0, Some("lamp `bulb` sends 5435 W/sr")),
        ("spot", 90.0, None),
        ("directional", 100_000.0, Some("brighter than the sun")),
        ("directional", 1000.0, None),
    ] {
        let workshop = Workshop::new();
        let lamp = json!({ "type": kind, "intensity": intensity, "spot": {} });
        lit_floor(None, lamp).write(&workshop.path("scene.glb"));
        let plan = workshop.run("assemble", &["plan", "scene.glb", "--element-size", "1"]);
        let noted = plan.stdout.lines().filter(|line| line.contains("--light-units")).collect::<Vec<_>>();
        match expected {
            None => assert!(noted.is_empty(), "{kind} {intensity}: {noted:?}"),
            Some(words) => {
                assert!(noted.len() == 1 && noted[0].contains(words), "{kind} {intensity}: {noted:?}")
            }
        }
    }
}

#[test]
fn a_scene_without_any_light_says_what_to_do() {
    let panel =
        || Node::new("panel", rectangle(part(grey(0.5, 1.0)), dvec3(0.0, 2.0, 0.0), DVec3::X, DVec3::Z));
    let mut off = panel();
    off.extras = json!({ "emission_scale": 0.0 });
    let write = |workshop: &Workshop, nodes: &[Node]| Model::of(nodes).write(&workshop.path("scene.glb"));
    for (case, nodes, sky, dark) in [
        ("nothing", vec![Node::new("floor", floor())], None, true),
        ("a sky", vec![Node::new("floor", floor())], Some("--sky=1"), false),
        ("a black sky", vec![Node::new("floor", floor())], Some("--sky=0"), true),
        ("a panel", vec![Node::new("floor", floor()), panel()], None, false),
        ("a panel that is off", vec![Node::new("floor", floor()), off], None, true),
    ] {
        let workshop = Workshop::new();
        write(&workshop, &nodes);
        for command in
            [&["plan", "scene.glb"][..], &["scene.glb", "--pictures", "none"], &["classic", "scene.glb"]]
        {
            let arguments = [command, &["--element-size", "1"], sky.as_slice()].concat();
            let ended = workshop.run("assemble", &arguments);
            assert_eq!(ended.code, Some(0), "{case}: {}", ended.stderr);
            let noted = ended.stdout.contains("note: no light: ")
                && ended.stdout.contains("Include > Punctual Lights");
            assert_eq!(noted, dark, "{case}, {command:?}: {}", ended.stdout);
        }
    }
}
