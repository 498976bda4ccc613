//! A level of few part files in many places: each part is baked once, and the light is that of the whole.

use equilux_assemble::proof::sample::ExactRows;
use equilux_assemble::report::Report;
use equilux_bake::oven::prepare::Division;
use equilux_bake::treecode::Resolution;
use equilux_tests::modular::{PARTS, places, write};
use equilux_tests::workshop::{Workshop, assembled};

/// With all that stands in them, 46 places.
const ROOMS: usize = 5;

/// The level with elements of a metre, compared with the classic matrix of all of it.
fn verified(tolerance: f64) -> Report {
    let workshop = Workshop::new();
    let scene = write(&workshop.path(""), ROOMS, |room| room);
    let mut job = workshop.job(Division::Authored);
    job.scene = scene;
    job.settings.preparation.resolution = Resolution::for_tolerance(tolerance);
    job.outputs.verify = true;
    job.outputs.exact_rows = Some(ExactRows::About(0));
    let report = assembled(&job);
    assert_eq!(
        (report.parts.len(), report.blocks.self_baked),
        (PARTS, PARTS),
        "parts, and how many were baked"
    );
    assert_eq!(report.instances, places(ROOMS));
    let lost: Vec<_> = report.notes.iter().filter(|note| note.contains("inside a solid")).collect();
    assert!(lost.is_empty(), "what stands on the floor is not in it: {lost:?}");
    report
}

#[test]
fn a_level_of_parts_is_lit_as_the_whole() {
    let report = verified(0.0);
    let off = report.verify.as_ref().expect("asked for").max_rel_diff;
    // Both are solved down to rounding; what is turned rounds otherwise in the scene's coordinates than in its own.
    assert!(off <= 1e-9, "{off} away from the whole");
}

#[test]
fn neighbourhoods_that_are_alike_share_their_blocks() {
    let workshop = Workshop::new();
    let mut job = workshop.job(Division::Authored);
    let rooms = 8;
    let scene = write(&workshop.path(""), rooms, |_| 0);
    job.scene = scene;
    job.outputs.verify = true;
    let report = assembled(&job);
    let off = report.verify.as_ref().expect("asked for").max_rel_diff;
    assert!(off <= 1e-9, "{off} away from the whole");
    // One room's worth is computed, and for the seven others what they see through doors of rooms further off: at the ends
    // of the row that is a door or nothing where the twin has a room.
    let share = report.form_factors_computed as f64 / report.form_factors_stored as f64;
    assert!(share <= 0.25, "{share} of all form factors were computed for {rooms} rooms that are alike");
}

#[test]
fn the_default_tolerance_keeps_a_level_within_it_and_within_what_is_proved() {
    let report = verified(0.01);
    let verify = report.verify.as_ref().expect("asked for");
    let (off, proved) = (verify.max_abs_diff, report.error.proved);
    assert!(off <= proved, "{off} W/m² away from the whole, proved are {proved}");
    assert!(verify.rms_rel_diff <= 0.01, "{} of the mean in RMS", verify.rms_rel_diff);
}
