//! Nothing is computed twice, and what changed is computed again: that part and no other.

use equilux_assemble::report::Report;
use equilux_bake::oven::prepare::Division;
use equilux_tests::model::{Model, Node};
use equilux_tests::rooms::{furnished, half, lamp, paint};
use equilux_tests::shapes::{joined, solid};
use equilux_tests::workshop::{Workshop, assembled};
use glam::dvec3;
use serde_json::json;

fn computed(report: &Report) -> Vec<&str> {
    report.parts.iter().filter(|p| p.form_factors == "computed").map(|p| p.name.as_str()).collect()
}

#[test]
fn a_second_run_computes_no_form_factor() {
    for division in [Division::Authored, Division::Bisect(3)] {
        let workshop = Workshop::with(&furnished());
        let first = assembled(&workshop.job(division.clone()));
        assert_eq!(computed(&first).len(), first.parts.len(), "{division:?}: parts baked at first");
        assert!(first.form_factors_computed > 0, "{division:?}: form factors computed at first");
        let second = assembled(&workshop.job(division.clone()));
        assert_eq!(computed(&second), Vec::<&str>::new(), "{division:?}: parts baked again");
        assert_eq!(second.form_factors_computed, 0, "{division:?}: form factors computed again");
        assert_eq!(second.energy.absorbed, first.energy.absorbed, "{division:?}: light from the cache");
    }
}

#[test]
fn a_repaint_changes_the_light_and_computes_no_form_factor() {
    let workshop = Workshop::with(&furnished());
    let before = assembled(&workshop.job(Division::Authored));
    // The walls' own colour, the picture's, and both the same, which leaves one material where there were two.
    for (material, colour) in [(0, [0.3, 0.6, 0.5]), (1, [0.9, 0.1, 0.1]), (1, [0.7, 0.6, 0.5])] {
        let pointer = format!("/materials/{material}/pbrMetallicRoughness/baseColorFactor");
        let [r, g, b] = colour;
        Model::of(&furnished()).with(&pointer, json!([r, g, b, 1.0])).write(&workshop.path("scene.glb"));
        let after = assembled(&workshop.job(Division::Authored));
        assert_eq!(after.form_factors_computed, 0, "form factors for material {material} in {colour:?}");
        assert_ne!(
            after.energy.absorbed, before.energy.absorbed,
            "light with material {material} in {colour:?}"
        );
    }
}

#[test]
fn a_dimmed_lamp_changes_the_light_and_computes_no_form_factor() {
    let mut nodes = furnished();
    let workshop = Workshop::with(&nodes);
    let before = assembled(&workshop.job(Division::Authored));
    nodes[2].extras["emission_scale"] = json!(0.5);
    Model::of(&nodes).write(&workshop.path("scene.glb"));
    let after = assembled(&workshop.job(Division::Authored));
    assert_eq!(after.form_factors_computed, 0, "form factors computed for a dimmed lamp");
    let ratio = after.energy.absorbed[0] / before.energy.absorbed[0];
    // Light is linear in emission; both were solved down to rounding.
    assert!((ratio - 0.5).abs() < 1e-9, "{ratio} of the light with half the emission");
}

/// The hall is lit, the kitchen is open to it.
fn write_house(workshop: &Workshop, kitchen: Vec<Node>) {
    std::fs::create_dir_all(workshop.path("parts")).expect("a folder");
    let light = solid(lamp([9.0; 3]), dvec3(0.5, 1.0, 0.5), dvec3(0.75, 1.25, 0.75));
    let hall = joined([half(paint([0.6; 3]), 0.0), light]);
    Model::of(&[Node::new("hall", hall)]).write(&workshop.path("parts/hall.glb"));
    Model::of(&kitchen).write(&workshop.path("parts/kitchen.glb"));
    Model::of(&[Node::of_file("hall", "parts/hall.glb"), Node::of_file("kitchen", "parts/kitchen.glb")])
        .write(&workshop.path("scene.glb"));
}

#[test]
fn only_the_part_whose_file_changed_is_baked_again() {
    let workshop = Workshop::new();
    let bare = half(paint([0.5; 3]), 2.0);
    write_house(&workshop, vec![Node::new("kitchen", bare.clone())]);
    let job = workshop.job(Division::Authored);
    assert_eq!(computed(&assembled(&job)), ["hall", "kitchen"], "parts baked at first");

    let stove = solid(paint([0.9; 3]), dvec3(3.0, 0.25, 0.5), dvec3(3.5, 1.0, 1.0));
    write_house(&workshop, vec![Node::new("kitchen", joined([bare, stove]))]);
    let report = assembled(&job);
    assert_eq!(computed(&report), ["kitchen"], "parts baked after the kitchen changed");
    let reason = &report.parts[1].reason;
    assert!(reason.contains("geometry changed"), "the kitchen's reason is '{reason}'");
}
