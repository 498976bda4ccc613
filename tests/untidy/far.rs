//! Scenes far from the origin of their file: the same light, in the file's coordinates, or a refusal with a reason.

use equilux_tests::cases::solve::{Setting, Solved, solved_file};
use equilux_tests::model::{Model, Node};
use equilux_tests::shapes::{grey, moved, part, rectangle, room};
use glam::{DAffine3, DVec3, dvec3};
use serde_json::json;

/// A room with a lamp, all corners on a grid of ¼ m.
fn nodes() -> [Node; 2] {
    let lamp = rectangle(part(grey(0.25, 4.0)), dvec3(0.5, 1.75, 0.5), DVec3::X, DVec3::Z);
    [Node::new("room", room(grey(0.5, 0.0), DVec3::ZERO, DVec3::splat(2.0))), Node::new("lamp", lamp)]
}

fn moved_by_nodes(offset: DVec3) -> Model {
    let model = Model::of(&nodes());
    let offset = json!(offset.to_array());
    model.with("/nodes/0/translation", offset.clone()).with("/nodes/1/translation", offset)
}

fn moved_by_vertices(offset: DVec3) -> Model {
    let by = DAffine3::from_translation(offset);
    Model::of(&nodes().map(|node| Node { part: node.part.map(|part| moved(part, by)), ..node }))
}

fn solve(model: &Model) -> Solved {
    solved_file(model, &Setting::metres(0.5)).unwrap_or_else(|error| panic!("{error}"))
}

#[test]
fn a_scene_far_away_has_the_same_light_where_the_file_has_it() {
    let near = solve(&Model::of(&nodes()));
    for k in 0..=6 {
        // Whole multiples of ¼ m up to 3·10⁶ m: every corner is what it was, in f32.
        let offset = dvec3(1.0, -2.0, 3.0) * 10f64.powi(k);
        for (how, model) in [("nodes", moved_by_nodes(offset)), ("vertices", moved_by_vertices(offset))] {
            let far = solve(&model);
            assert_eq!(far.elements.len(), near.elements.len(), "{how}, 10^{k} m");
            for (far, near) in far.elements.iter().zip(&near.elements) {
                assert_eq!(far.centroid, near.centroid + offset, "{how}, 10^{k} m: the file's coordinates");
                // The same sums, but for the rounding of corners at 3·10⁶ m in f64.
                let off = (far.radiosity[0] / near.radiosity[0] - 1.0).abs();
                assert!(off < 1e-9, "{how}, 10^{k} m: {} for {}", far.radiosity[0], near.radiosity[0]);
            }
            let said = &far.report.notes;
            assert!(k > 3 || said.iter().all(|note| !note.contains("f32")), "{how}, 10^{k} m: {said:?}");
        }
    }
}

#[test]
fn beyond_what_f32_can_tell_the_file_is_refused() {
    for (how, model) in [
        ("nodes", moved_by_nodes(dvec3(2e7, 0.0, 0.0))),
        ("vertices", moved_by_vertices(dvec3(0.0, 0.0, 2e7))),
    ] {
        let error =
            solved_file(&model, &Setting::metres(0.5)).map(|_| ()).expect_err("too far away").to_string();
        for part in ["scene.glb", "f32", "2 m", "0.5 m", "origin"] {
            assert!(error.contains(part), "{how}: {error}");
        }
    }
}
