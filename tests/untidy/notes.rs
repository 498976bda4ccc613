//! Notes name problems of a scene, and there are none without problems.

use equilux_formats::Part;
use equilux_tests::cases::solve::{Setting, light};
use equilux_tests::model::Node;
use equilux_tests::shapes::{grey, part, rectangle, room, solid};
use glam::{DVec3, dvec3};

fn notes(nodes: &[Node], size: f64) -> Vec<String> {
    light(nodes, &Setting::metres(size)).report.notes
}

/// The notes about the scene or its light.
fn judgements(notes: &[String]) -> Vec<&String> {
    let words = ["black back", "sees", "absorbs", "in one plane"];
    notes.iter().filter(|note| words.iter().any(|word| note.contains(word))).collect()
}

fn lamp() -> Part {
    rectangle(part(grey(0.0, 9.0)), dvec3(1.5, 2.5, 2.0), DVec3::X, DVec3::Z)
}

fn hall() -> Part {
    room(grey(0.7, 0.0), DVec3::ZERO, dvec3(4.0, 3.0, 5.0))
}

#[test]
fn a_wall_that_is_inside_out_is_named() {
    let crate_ = || Node::new("crate", solid(grey(0.5, 0.0), dvec3(0.5, 0.0, 0.5), dvec3(1.5, 1.0, 1.5)));
    let tidy = [Node::new("hall", hall()), Node::new("lamp", lamp()), crate_()];
    let said = notes(&tidy, 0.5);
    assert!(judgements(&said).is_empty(), "{said:?}");
    for wall in 0..6 {
        let mut walls = hall();
        walls.surfaces[wall] = walls.surfaces[wall].flipped();
        let normal = walls.surfaces[wall].corners.double_area_vector().normalize();
        let said = notes(&[Node::new("hall", walls), Node::new("lamp", lamp()), crate_()], 0.5);
        let said: Vec<&String> = said.iter().filter(|note| note.contains("black back")).collect();
        let [note] = said[..] else { panic!("wall {wall}: {said:?}") };
        let direction = format!("({}, {}, {})", normal.x + 0.0, normal.y + 0.0, normal.z + 0.0);
        assert!(note.contains("`hall`") && note.contains(&direction), "wall {wall}, {direction}: {note}");
    }
    // All of it: one note, not six.
    let mut walls = hall();
    walls.surfaces.iter_mut().for_each(|surface| *surface = surface.flipped());
    let said = notes(&[Node::new("hall", walls), Node::new("lamp", lamp()), crate_()], 0.5);
    assert_eq!(said.iter().filter(|note| note.contains("black back")).count(), 1, "{said:?}");
}

#[test]
fn sheets_and_lamps_that_show_both_sides_are_not_named() {
    let sheet = rectangle(part(grey(0.5, 0.0)), dvec3(1.0, 0.5, 1.0), DVec3::Y, DVec3::X);
    let said =
        notes(&[Node::new("hall", hall()), Node::new("lamp", lamp()), Node::new("sheet", sheet)], 0.25);
    assert!(judgements(&said).is_empty(), "{said:?}");
}

/// The crate's bottom lies in the plane of the floor's other side, which is never seen.
#[test]
fn a_crate_on_a_two_sided_floor_is_not_named() {
    let mut walls = hall();
    walls.materials[0].double_sided = true;
    let crate_ = || solid(grey(0.5, 0.0), dvec3(0.5, 0.0, 0.5), dvec3(1.5, 1.0, 1.5));
    let mut soft = crate_();
    soft.materials[0].double_sided = true;
    for crate_ in [crate_(), soft] {
        let nodes = [Node::new("hall", walls.clone()), Node::new("lamp", lamp()), Node::new("crate", crate_)];
        let said = notes(&nodes, 0.25);
        assert!(judgements(&said).is_empty(), "{said:?}");
    }
}

#[test]
fn a_closed_scene_that_gains_light_says_between_what() {
    // A lamp that faces the ceiling from a millimetre below.
    let up = rectangle(part(grey(0.0, 9.0)), dvec3(1.5, 2.999, 2.0), DVec3::Z, DVec3::X);
    let said = notes(&[Node::new("hall", hall()), Node::new("lamp", up)], 0.3);
    let said = judgements(&said);
    let [note] = said[..] else { panic!("{said:?}") };
    assert!(note.contains("`hall`") && note.contains("`lamp`") && note.contains("absorbs"), "{note}");
}
