//! Work that does not change any radiosity is left out and reported, without a difference in the result.

use equilux_assemble::exchange::settings::{Goal, Method};
use equilux_assemble::report::Report;
use equilux_assemble::report::summary::{BLACK_ROWS, DARK_SOLVES, UNSEEN};
use equilux_bake::oven::prepare::Division;
use equilux_formats::{Material, Rgb};
use equilux_tests::model::Node;
use equilux_tests::rooms::{half, lamp, paint};
use equilux_tests::shapes::{joined, room, solid};
use equilux_tests::workshop::{Workshop, assembled};
use glam::{DVec3, dvec3};

fn count(report: &Report, reason: &str) -> usize {
    report.blocks.coupling_left_out.get(reason).copied().unwrap_or(0)
}

/// A room of two halves, the second of another reflectance, a lamp in the first, and a sealed box somewhere else.
fn scene(reflectance: [f64; 3]) -> Vec<Node> {
    let light = solid(lamp([9.0; 3]), dvec3(0.5, 1.0, 0.5), dvec3(0.75, 1.25, 0.75));
    let sealed = Material { emission: Rgb([1.0; 3]), ..paint([0.5; 3]) };
    vec![
        Node::new("dark half", half(paint(reflectance), 2.0)),
        Node::new("lit half", joined([half(paint([0.5; 3]), 0.0), light])),
        Node::new("sealed box", room(sealed, DVec3::splat(9.0), DVec3::splat(10.0))),
    ]
}

/// The report and the table of elements without the columns of reflectance and radiosity.
fn irradiance(nodes: &[Node]) -> (Report, Vec<Vec<String>>) {
    let workshop = Workshop::with(nodes);
    let table = workshop.path("table.csv");
    let mut job = workshop.job(Division::Authored);
    job.outputs.elements = Some(table.clone());
    let report = assembled(&job);
    let text = std::fs::read_to_string(table).expect("the table");
    let row = |line: &str| line.split(',').skip(13).take(3).map(String::from).collect();
    (report, text.lines().skip(1).map(row).collect())
}

#[test]
fn rows_of_black_receivers_wait_for_the_end_and_lack_nothing() {
    let (report, black) = irradiance(&scene([0.0; 3]));
    // Five sides of 2 × 2 m in elements of a metre.
    assert_eq!(count(&report, BLACK_ROWS), 20, "{:?}", report.blocks.coupling_left_out);
    assert!(report.converged, "{:?}", report.rounds.last());

    // What reflects 1e-30 takes part in every round, and adds less than the last bit to anything else.
    let (report, nearly) = irradiance(&scene([1e-30; 3]));
    assert_eq!(count(&report, BLACK_ROWS), 0, "{:?}", report.blocks.coupling_left_out);
    assert_eq!(black, nearly, "irradiance, to the last bit");
    assert!(black.iter().flatten().all(|h| h != "0"), "an element without irradiance in {black:?}");
}

#[test]
fn parts_that_hear_nothing_new_are_not_solved() {
    let workshop = Workshop::with(&scene([0.5; 3]));
    let goal = Goal { error: 1e-3, rounds: usize::MAX };
    let mut job = workshop.job(Division::Authored);
    job.settings.method = Method::Jacobi;
    job.settings.goal = goal;
    let report = assembled(&job);
    // All light is in one half, then all that is new in the other, and so on to and fro.
    assert_eq!(count(&report, DARK_SOLVES), report.rounds.len(), "{:?}", report.blocks.coupling_left_out);
}

#[test]
fn parts_that_cannot_see_each_other_are_not_coupled() {
    let workshop = Workshop::with(&scene([0.5; 3]));
    let mut job = workshop.job(Division::Authored);
    job.outputs.verify = true;
    let report = assembled(&job);
    // The sealed box sees neither half, nor they it.
    assert_eq!(count(&report, UNSEEN), 4, "{:?}", report.blocks.coupling_left_out);
    let difference = report.verify.as_ref().expect("asked for").max_rel_diff;
    assert!(difference <= 1e-10, "{difference} away from the whole");
    let said = report.details();
    assert!(said.contains(&format!("left out: 4 {UNSEEN}")), "nothing of it in\n{said}");
}
