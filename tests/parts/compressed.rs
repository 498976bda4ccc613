//! Entries for clusters: smaller and faster than the exact matrix, as wrong as asked for, and never more than proved.

use crate::workshop::{Workshop, assembled};
use equilux_bake::elements::ElementSize;
use equilux_bake::prepare::Division;
use equilux_bake::treecode::Resolution;
use equilux_tests::levels::furnished;
use equilux_tests::shapes::{alone, coupling, fine};

#[test]
fn the_bound_covers_what_tolerance_takes_and_the_error_is_what_was_asked_for() {
    for tolerance in [0.1, 0.03, 0.01] {
        let workshop = Workshop::new();
        let mut job = workshop.job(Division::Authored);
        job.scene = concat!(env!("CARGO_MANIFEST_DIR"), "/../scenes/corridor/corridor.glb").into();
        job.preparation.element_size = Some(ElementSize::Metres(0.2));
        job.preparation.resolution = Resolution::for_tolerance(tolerance);
        job.verify = true;
        let report = assembled(&job);
        let verify = report.verify.as_ref().expect("asked for");
        assert!(verify.rms_rel_diff > 0.0, "nothing was compressed");
        // The opening was chosen by measuring finer elements, where more is compressed.
        assert!(verify.rms_rel_diff <= tolerance, "{} for {tolerance}", verify.rms_rel_diff);
        let bound = report.rounds.last().expect("rounds").error_bound;
        assert!(verify.max_abs_diff <= bound, "off by {}, proved {bound}", verify.max_abs_diff);
        // Entries are exact; a row is searched until a millionth is missing, and kept in 16-bit steps.
        assert!(report.row_sum_defect.max <= 1e-5, "row sums off by {}", report.row_sum_defect.max);
        assert!(report.bytes.stored * 4 < report.bytes.dense, "{} bytes", report.bytes.stored);
    }
}

#[test]
fn rows_of_a_furnished_room_reach_one_at_any_opening() {
    // One room without doors: closed, with seventeen boxes in it.
    let geometry = fine(&furnished(1)[0], 0.3);
    for tolerance in [0.3, 0.03, 0.003, 0.0] {
        let block = coupling(&alone(&geometry), 0, &[0], Resolution::for_tolerance(tolerance));
        let worst = (0..block.receivers()).map(|i| (block.row_sum(i) - 1.0).abs()).fold(0.0, f64::max);
        // Exact rows stop when 1e-12 is missing, others at 1e-6 and in steps of about as much.
        let allowed = if tolerance == 0.0 { 2e-12 } else { 1e-5 };
        assert!(worst <= allowed, "tolerance {tolerance}: a row is {worst} from one");
    }
}
