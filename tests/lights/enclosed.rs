//! Notes name lamps in closed meshes and lamps that light nothing, but not lamps in rooms.

use equilux_bake::oven::prepare::Division;
use equilux_formats::{Material, Part};
use equilux_tests::cases::solve::{Setting, light};
use equilux_tests::model::{Model, Node};
use equilux_tests::shapes::{grey, joined, part, quad, rectangle, room, solid};
use equilux_tests::workshop::{Workshop, assembled};
use glam::{DVec3, dvec3};
use serde_json::json;

/// The notes about lamps in a scene of these nodes with a punctual light, or none, at a point.
fn notes(nodes: &[Node], kind: Option<&str>, at: DVec3) -> Vec<String> {
    let workshop = Workshop::new();
    let mut model = Model::of(nodes);
    if let Some(kind) = kind {
        let looking_down = json!([-0.5_f64.sqrt(), 0, 0, 0.5_f64.sqrt()]);
        let lamp = json!({ "name": "bulb", "translation": at.to_array(), "rotation": looking_down,
            "extensions": { "KHR_lights_punctual": { "light": 0 } } });
        model.json["extensions"] =
            json!({ "KHR_lights_punctual": { "lights": [{ "type": kind, "spot": {} }] } });
        model.json["nodes"].as_array_mut().expect("nodes").push(lamp);
        model.json["scenes"][0]["nodes"].as_array_mut().expect("roots").push(json!(nodes.len()));
    }
    model.write(&workshop.path("scene.glb"));
    let report = assembled(&workshop.job(Division::Authored));
    report.notes.into_iter().filter(|note| note.contains("lamp")).collect()
}

fn hall() -> Node {
    Node::new("hall", room(grey(0.5, 0.0), DVec3::ZERO, dvec3(4.0, 3.0, 5.0)))
}

const LAMP_AT: DVec3 = dvec3(2.0, 2.0, 2.5);

/// A box of 0.4 m around the lamp, a shade of it on its own, as modelling programs make it.
fn shade(double_sided: bool, inwards: bool, open: bool) -> Node {
    let glass = Material { double_sided, ..grey(0.5, 0.0) };
    let make = if inwards { room } else { solid };
    let mut part = make(glass, LAMP_AT - 0.2, LAMP_AT + 0.2);
    if open {
        part.surfaces.pop();
    }
    Node::new("shade", part)
}

/// A small panel at the lamp's place that emits downwards.
fn filament() -> Part {
    rectangle(part(grey(0.0, 5.0)), LAMP_AT - dvec3(0.05, 0.0, 0.05), 0.1 * DVec3::X, 0.1 * DVec3::Z)
}

#[test]
fn a_lamp_in_a_closed_mesh_is_named_whatever_shines_and_however_it_is_wound() {
    for (case, shade, named) in [
        ("outwards", shade(false, false, false), true),
        ("two-sided", shade(true, false, false), true),
        ("two-sided, wound inwards", shade(true, true, false), true),
        ("outwards, open", shade(false, false, true), false),
        ("two-sided, open", shade(true, false, true), false),
        ("a room", shade(false, true, false), false),
    ] {
        for punctual in [true, false] {
            let mut nodes = vec![hall(), shade.clone()];
            let (kind, lamp) = if punctual { (Some("point"), "bulb") } else { (None, "filament") };
            if !punctual {
                nodes.push(Node::new("filament", filament()));
            }
            let said = notes(&nodes, kind, LAMP_AT);
            let expected = format!("lamp `{lamp}` stands inside `shade`");
            let found = said.iter().any(|note| note.contains(&expected));
            assert_eq!(found, named, "{case}, punctual: {punctual}: {said:?}");
            assert!(said.len() <= 1, "{case}, punctual: {punctual}: {said:?}");
        }
    }
}

#[test]
fn a_lamp_of_the_same_mesh_as_its_shade_is_named() {
    let glass = Material { double_sided: true, ..grey(0.5, 0.0) };
    let fixture = joined([solid(glass, LAMP_AT - 0.2, LAMP_AT + 0.2), filament()]);
    let said = notes(&[hall(), Node::new("fixture", fixture)], None, LAMP_AT);
    assert!(said.len() == 1 && said[0].contains("lamp `fixture` stands inside `fixture`"), "{said:?}");
}

/// Blender's rooms are two-sided boxes.
#[test]
fn a_lamp_in_a_room_is_not_named() {
    let walls = Material { double_sided: true, ..grey(0.5, 0.0) };
    let hall = Node::new("hall", solid(walls.clone(), DVec3::ZERO, dvec3(4.0, 3.0, 5.0)));
    let crate_ =
        |x: f64| Node::new("crate", solid(walls.clone(), dvec3(x, 0.2, 0.5), dvec3(x + 1.0, 1.2, 1.5)));
    let lamp = Node::new("filament", filament());
    for (case, nodes) in [
        ("alone", vec![hall.clone()]),
        ("furnished", vec![hall.clone(), crate_(0.5)]),
        ("furnished, beside others", vec![hall.clone(), crate_(0.5), crate_(9.0), crate_(20.0)]),
    ] {
        for kind in [Some("point"), None] {
            let nodes =
                if kind.is_some() { nodes.clone() } else { [nodes.clone(), vec![lamp.clone()]].concat() };
            assert_eq!(notes(&nodes, kind, LAMP_AT), Vec::<String>::new(), "{case}, {kind:?}");
        }
    }
}

#[test]
fn a_lamp_that_lights_nothing_is_named() {
    let floor =
        || Node::new("floor", rectangle(part(grey(0.5, 0.0)), DVec3::ZERO, 4.0 * DVec3::Z, 4.0 * DVec3::X));
    let above = dvec3(1.0, 2.0, 1.0);
    for (case, kind, at, named) in [
        ("above", Some("point"), above, false),
        ("below", Some("point"), -above, true),
        ("above, looking down", Some("spot"), above, false),
        ("beside, looking down", Some("spot"), above + 90.0 * DVec3::X, true),
        ("from above", Some("directional"), above, false),
    ] {
        let said = notes(&[floor()], kind, at);
        assert_eq!(
            said.iter().any(|note| note.contains("lamp `bulb` lights nothing")),
            named,
            "{case}: {said:?}"
        );
        assert_eq!(said.len(), usize::from(named), "{case}: {said:?}");
    }
    // The sun under a roof; a panel that looks up; and one that looks down.
    let roof = Node::new(
        "roof",
        quad(part(grey(0.5, 0.0)), [[0., 0.], [0., 4.], [4., 4.], [4., 0.]].map(|[x, z]| dvec3(x, 3.0, z))),
    );
    let mut under = roof.clone();
    let flipped = under.part.as_mut().expect("a part");
    flipped.surfaces[0] = flipped.surfaces[0].flipped();
    let said = notes(&[floor(), under], Some("directional"), above);
    assert!(said.len() == 1 && said[0].contains("lamp `bulb` lights nothing"), "{said:?}");
    for (up, named) in [(true, true), (false, false)] {
        let mut panel = rectangle(part(grey(0.0, 1.0)), above, DVec3::X, DVec3::Z);
        if up {
            panel.surfaces[0] = panel.surfaces[0].flipped();
        }
        let report = light(&[floor(), Node::new("panel", panel)], &Setting::metres(1.0)).report;
        let found = report.notes.iter().any(|note| note.contains("lamp `panel` lights nothing"));
        assert_eq!(found, named, "a panel that looks up: {up}: {:?}", report.notes);
    }
}
