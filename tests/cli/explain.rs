//! `bake --explain` says why each part was or was not baked.

use equilux_tests::model::{Model, Node};
use equilux_tests::rooms::{half, paint};
use equilux_tests::shapes::{joined, solid};
use equilux_tests::workshop::Workshop;
use glam::dvec3;

#[test]
fn bake_says_in_a_sentence_why_a_part_is_baked_or_reused() {
    let room = half(paint([0.5; 3]), 0.0);
    let workshop = Workshop::with(&[Node::new("room", room.clone())]);
    let says = |arguments: &[&str], words: &[&str]| {
        let ended = workshop.run("bake", &[&["scene.glb", "--explain"], arguments].concat());
        assert_eq!(ended.code, Some(0), "{}", ended.stderr);
        for words in words {
            assert!(ended.stdout.contains(words), "{arguments:?}: no '{words}' in\n{}", ended.stdout);
        }
    };
    let coarse = ["--element-size", "1"];
    says(&coarse, &["form factors computed: never computed before", "1 baked, 0 reused"]);
    says(&coarse, &["form factors reused: all inputs are unchanged", "0 baked, 1 reused"]);
    says(
        &["--element-size", "0.5"],
        &["form factors computed: element size was 1 m, is 0.5 m", "1 baked, 0 reused"],
    );
    says(&coarse, &["form factors reused"]);

    let with_box = joined([room.clone(), solid(paint([0.5; 3]), dvec3(0.5, 0.5, 0.5), dvec3(1.0, 1.0, 1.0))]);
    Model::of(&[Node::new("room", with_box)]).write(&workshop.path("scene.glb"));
    says(&coarse, &["form factors computed: geometry changed\n", "1 baked, 0 reused"]);

    Model::of(&[Node::new("room", room)]).write(&workshop.path("scene.glb"));
    says(&coarse, &["form factors reused", "light reused"]);
    let painted = Model::of(&[Node::new("room", half(paint([0.4; 3]), 0.0))]);
    painted.write(&workshop.path("scene.glb"));
    says(&coarse, &["form factors reused", "light computed: reflectance changed"]);
}
