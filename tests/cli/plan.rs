//! `assemble plan` predicts what the following run does.

use equilux_assemble::report::summary::{BLACK_ROWS, SHARED, UNSEEN};
use equilux_tests::model::{Model, Node};
use equilux_tests::rooms::{furnished, lamp, paint};
use equilux_tests::shapes::{joined, part, rectangle, room, solid};
use equilux_tests::workshop::Workshop;
use glam::{DVec3, dvec3};
use serde_json::{Value, json};

fn object(workshop: &Workshop, arguments: &[&str]) -> Value {
    let ended = workshop.run("assemble", &[arguments, &["--rounds", "2", "--json"]].concat());
    assert_eq!(ended.code, Some(0), "{arguments:?}: {}", ended.stderr);
    serde_json::from_str(&ended.stdout).unwrap_or_else(|_| panic!("not one object: {}", ended.stdout))
}

/// The plan, verified by a run.
fn planned_and_done(workshop: &Workshop, size: &str) -> Value {
    let plan = object(workshop, &["plan", "scene.glb", "--element-size", size]);
    let report = object(workshop, &["scene.glb", "--element-size", size]);
    let parts = |value: &Value, pointer: &str| -> Vec<Value> {
        let parts = value["parts"].as_array().expect("a list");
        parts.iter().map(|part| part.pointer(pointer).expect("a value").clone()).collect()
    };
    assert_eq!(parts(&plan, "/form_factors/how"), parts(&report, "/form_factors"), "parts");
    let reasons = parts(&plan, "/form_factors/reason");
    let said = parts(&report, "/reason").into_iter();
    let said =
        said.map(|reason| reason.as_str().and_then(|r| Some(r.split_once(": ")?.1.into())).unwrap_or(reason));
    assert_eq!(reasons, said.collect::<Vec<Value>>(), "reasons");
    let places = plan["instances"].as_array().expect("a list");
    let couplings = places.iter().filter(|place| place["coupling"]["how"] == "computed").count();
    let computed = report["blocks"]["coupling_computed"].as_u64().expect("a number");
    assert_eq!(couplings > 0, computed > 0, "{couplings} couplings planned, {computed} computed");
    let corrected = places.iter().filter(|place| !place["corrected"].is_null()).count();
    assert_eq!(report["blocks"]["self_corrected"], corrected, "own blocks corrected");
    assert_eq!(plan["elements"], report["elements"]);
    assert_eq!(plan["classic_matrix_bytes"], report["bytes"]["dense"]);
    plan
}

fn count(plan: &Value, how: &str) -> usize {
    plan["parts"].as_array().expect("a list").iter().filter(|part| part["form_factors"]["how"] == how).count()
}

#[test]
fn a_plan_writes_nothing_and_says_what_the_run_then_does() {
    let workshop = Workshop::with(&furnished());
    let arguments = ["plan", "scene.glb", "--element-size", "1"];
    let ended = workshop.run("assemble", &arguments);
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    assert!(ended.stdout.contains("part table: "), "{}", ended.stdout);
    assert!(ended.stdout.contains("inside walls is crate, light, table"), "{}", ended.stdout);
    assert_eq!(workshop.files("").len(), 1, "files beside the scene: {:?}", workshop.files("").keys());

    assert_eq!(count(&planned_and_done(&workshop, "1"), "computed"), 4, "from nothing");
    assert_eq!(count(&planned_and_done(&workshop, "1"), "reused"), 4, "once more");
    // Another paint needs no form factor.
    let painted = Model::of(&furnished())
        .with("/materials/0/pbrMetallicRoughness/baseColorFactor", json!([0.3, 0.2, 0.1, 1.0]));
    painted.write(&workshop.path("scene.glb"));
    assert_eq!(count(&planned_and_done(&workshop, "1"), "reused"), 4, "painted");
    let mut nodes = furnished();
    let lid = solid(paint([0.5; 3]), dvec3(0.5, 1.125, 1.75), dvec3(0.75, 1.25, 2.0));
    nodes[3].part = nodes[3].part.take().map(|crate_| joined([crate_, lid]));
    Model::of(&nodes).write(&workshop.path("scene.glb"));
    let plan = planned_and_done(&workshop, "1");
    assert_eq!([count(&plan, "computed"), count(&plan, "reused")], [1, 3], "a lid over the crate: {plan}");
    assert_eq!(count(&planned_and_done(&workshop, "0.5"), "computed"), 4, "smaller elements");
}

#[test]
fn a_plan_knows_why_couplings_are_computed() {
    let mut nodes = furnished();
    let workshop = Workshop::with(&nodes);
    planned_and_done(&workshop, "1");
    nodes[3].at = dvec3(0.5, 0.0, 0.0);
    Model::of(&nodes).write(&workshop.path("scene.glb"));
    let plan = planned_and_done(&workshop, "1");
    assert_eq!(count(&plan, "reused"), 4, "a crate was moved, which changes no part: {plan}");
    let reason = plan["instances"][3]["coupling"]["reason"].as_str().expect("a sentence");
    assert_eq!(reason, "instance 0 (crate) changed");
}

#[test]
fn a_plan_names_parts_that_face_away_and_counts_what_is_left_out() {
    let panel = |x: f64| rectangle(part(lamp([1.0; 3])), dvec3(x, 1.99, 0.5), DVec3::X / 4.0, DVec3::Z / 4.0);
    let black = room(paint([0.0; 3]), DVec3::ZERO, dvec3(4.0, 2.0, 2.0));
    let mut second = Node::new("second lamp", panel(1.0));
    second.at = dvec3(1.5, 0.0, 0.0);
    let workshop = Workshop::with(&[Node::new("walls", black), Node::new("lamp", panel(1.0)), second]);
    let plan = object(&workshop, &["plan", "scene.glb", "--element-size", "1"]);
    assert_eq!(plan["unseen"], json!([["lamp", "second lamp"]]));
    let report = object(&workshop, &["scene.glb", "--element-size", "1"]);
    for (reason, expected) in [(UNSEEN, 2), (BLACK_ROWS, 40), (SHARED, 1)] {
        for (value, left_out) in [(&plan, "/left_out"), (&report, "/blocks/coupling_left_out")] {
            let counts = value.pointer(left_out).expect("counts");
            assert_eq!(counts[reason], expected, "{reason} in {left_out}: {counts}");
        }
    }
}
