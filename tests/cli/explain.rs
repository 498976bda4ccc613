//! `--explain` prints why each part was or was not baked, and why each block was computed, reused or left out.

use equilux_tests::model::{Model, Node};
use equilux_tests::rooms::{furnished, half, paint};
use equilux_tests::shapes::{joined, room, solid};
use equilux_tests::workshop::Workshop;
use glam::{DVec3, dvec3};
use serde_json::json;

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

#[test]
fn assemble_says_in_a_sentence_what_became_of_each_part_and_block() {
    let sealed = room(paint([0.5; 3]), DVec3::splat(9.0), DVec3::splat(10.0));
    let nodes = || [furnished(), vec![Node::new("sealed", sealed.clone())]].concat();
    let workshop = Workshop::with(&nodes());
    let said = |arguments: &[&str]| {
        // By rays, what touches a part has a block and light of its own, and is not only repainted.
        let common = ["scene.glb", "--element-size", "1", "--rounds", "2", "--rows", "exact"];
        let all = [&common[..], arguments].concat();
        let ended = workshop.run("assemble", &all);
        assert_eq!(ended.code, Some(0), "{}", ended.stderr);
        ended.stdout
    };
    let has = |said: &str, lines: &[&str]| {
        for line in lines {
            assert!(said.lines().any(|l| l.contains(line)), "no line with '{line}' in\n{said}");
        }
    };
    let new = "computed: never computed before";
    let first = said(&["--explain"]);
    has(
        &first,
        &[
            "part table: 22 elements in 1 place, solved by GaussSeidel; form factors computed: never",
            &format!("; light {new}"),
            &format!("inside walls is crate, light, table: its own form factors {new}"),
            &format!("coupling of table {new}; left out: sealed, of which it sees nothing"),
            &format!(
                "coupling of sealed {new}; left out: crate, light, table, walls, of which it sees nothing"
            ),
        ],
    );
    assert!(!said(&[]).contains("coupling of"), "explained without being asked");

    let mut painted = nodes();
    painted[3].extras["materials"] = json!({ "paint": { "baseColorFactor": [0.25, 0.5, 0.75, 1] } });
    Model::of(&painted).write(&workshop.path("scene.glb"));
    has(
        &said(&["--explain"]),
        &[
            "form factors reused: all inputs are unchanged; light reused: all inputs are unchanged",
            "coupling of table reused: all inputs are unchanged; left out: sealed",
            "light of crate, repainted, computed: never computed before",
        ],
    );
    assert!(said(&[]).contains("form factors: all from the cache"), "nothing was left to compute");
    let report: serde_json::Value = serde_json::from_str(&said(&["--explain", "--json"])).expect("a report");
    assert_eq!(report["explained"].as_array().map(Vec::len), Some(5 + 5 + 1 + 1), "{report:#}");
}
