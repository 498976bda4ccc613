//! Entries for clusters: smaller and faster than the exact matrix, within the requested tolerance, and never worse than proved.

use equilux_assemble::proof::sample::ExactRows;
use equilux_assemble::report::Report;
use equilux_assemble::run::job::Job;
use equilux_bake::elements::ElementSize;
use equilux_bake::oven::prepare::Division;
use equilux_bake::treecode::Resolution;
use equilux_tests::shapes::{alone, coupling, fine};
use equilux_tests::workshop::{Workshop, assembled, changed};
use equilux_tests::{levels, rooms};

fn shipped(workshop: &Workshop, scene: &str, size: ElementSize, tolerance: f64) -> Job {
    let mut job = workshop.job(Division::Authored);
    let root = concat!(env!("CARGO_MANIFEST_DIR"), "/../scenes");
    job.scene = format!("{root}/{scene}/{scene}.glb").into();
    job.settings.preparation.element_size = Some(size);
    job.settings.preparation.resolution = Resolution::for_tolerance(tolerance);
    job.outputs.verify = true;
    job
}

#[test]
fn the_error_is_what_was_asked_for_and_the_bound_covers_it() {
    for tolerance in [0.1, 0.03, 0.01] {
        let workshop = Workshop::new();
        let report = assembled(&shipped(&workshop, "corridor", ElementSize::Metres(0.2), tolerance));
        let verify = report.verify.as_ref().expect("asked for");
        assert!(verify.rms_rel_diff > 0.0, "nothing was compressed");
        // The opening was chosen by measuring.
        assert!(verify.rms_rel_diff <= tolerance, "{} for {tolerance}", verify.rms_rel_diff);
        covers(&report, &format!("corridor, {tolerance}"));
        // Entries are exact; a row is searched until a millionth is missing, and kept as f32.
        assert!(report.row_sum_defect.max <= 1e-5, "row sums off by {}", report.row_sum_defect.max);
        assert!(report.bytes.stored * 4 < report.bytes.dense, "{} bytes", report.bytes.stored);
    }
}

/// Proved errors are at least those against the classic matrix, for any element and in the mean.
fn covers(report: &Report, what: &str) {
    let (error, verify) = (&report.error, report.verify.as_ref().expect("asked for"));
    let (proved, off) = (error.proved, verify.max_abs_diff);
    assert!(off <= proved, "{what}: off by {off}, proved {proved} from {}", error.proved_from);
    let (proved, off) = (error.proved_rms, verify.rms_rel_diff);
    assert!(off <= proved, "{what}: RMS {off}, proved {proved} from {}", error.proved_from);
    let exchange = report.rounds.last().expect("rounds").error_bound;
    assert!(
        exchange <= error.proved,
        "{what}: the exchange alone may be off by {exchange}, all by {}",
        error.proved
    );
}

/// Checks a scene with all rows exact and with some, and returns the proved error of the first over its true error.
fn exact_rows_tell_the_error(job: &Job, what: &str) -> f64 {
    let all = assembled(&changed(job.clone(), |job| {
        job.outputs.exact_rows = Some(ExactRows::All);
    }));
    let some = assembled(&changed(job.clone(), |job| {
        job.outputs.exact_rows = Some(ExactRows::About(256));
        job.outputs.verify = false;
    }));
    let verify = all.verify.as_ref().expect("asked for");
    covers(&all, what);
    assert_eq!(all.error.proved_from, "exact rows", "{what}");
    assert_eq!(some.error.proved_from, "spread", "{what}");
    assert_eq!(some.error.spread, Some(some.error.proved), "{what}: nothing else proves");
    assert_eq!(all.error.spread, some.error.spread, "{what}: what spreads prove knows of no rows");
    assert!(all.error.proved <= some.error.proved, "{what}: exact rows prove less than spreads");

    let [all_rows, rows] = [&all, &some].map(|r| r.error.exact_rows.as_ref().expect("rows"));
    assert_eq!(all_rows.rows, all.elements, "{what}: rows of all");
    // Whole clusters, and at least one a part: not exactly as many as asked for.
    assert!((128..=512).contains(&rows.rows), "{what}: {} rows for 256", rows.rows);
    let ratio = rows.residual_rms_rel / all_rows.residual_rms_rel;
    // A dozen clusters stand for a few hundred; measured: 0.8 to 1.5.
    assert!((0.5..=2.0).contains(&ratio), "{what}: the sample's residual is {ratio} times that of all rows");
    let ratio = rows.estimated_rms_rel / verify.rms_rel_diff;
    // The estimate takes all residuals to have one sign, which they have not; measured: 1.2 to 2.6.
    assert!((0.7..=4.0).contains(&ratio), "{what}: the estimate is {ratio} times the error");
    all.error.proved / verify.max_abs_diff
}

#[test]
fn exact_rows_tell_the_error_of_the_shadow_scene() {
    let workshop = Workshop::new();
    let job = shipped(&workshop, "shadow", ElementSize::Mesh, 0.03);
    let slack = exact_rows_tell_the_error(&job, "shadow");
    // The residual is exact, and its reflections are added without signs; measured: 1.05 to 1.2.
    assert!(slack <= 2.0, "all exact rows prove {slack} times the error");
}

#[test]
fn exact_rows_tell_the_error_of_a_furnished_room() {
    let workshop = Workshop::with(&rooms::furnished());
    let mut job = workshop.job(Division::Bisect(3));
    job.settings.preparation.element_size = Some(ElementSize::Metres(0.25));
    job.settings.preparation.resolution = Resolution::for_tolerance(0.1);
    job.outputs.verify = true;
    let slack = exact_rows_tell_the_error(&job, "furnished room");
    assert!(slack <= 2.0, "all exact rows prove {slack} times the error");
}

#[test]
fn a_scene_of_fewer_rows_than_asked_for_has_them_all_exact_and_an_exact_one_none() {
    let workshop = Workshop::with(&rooms::furnished());
    let mut job = workshop.job(Division::Authored);
    job.outputs.exact_rows = Some(ExactRows::About(10_000));
    assert!(assembled(&job).error.exact_rows.is_none(), "rows beside an exact matrix");
    job.settings.preparation.resolution = Resolution::for_tolerance(0.3);
    let report = assembled(&job);
    assert_eq!(report.error.exact_rows.expect("rows").rows, report.elements);
    job.outputs.exact_rows = Some(ExactRows::About(0));
    let report = assembled(&job);
    assert!(report.error.exact_rows.is_none(), "rows where none were asked for");
    assert!(report.error.spread.is_some(), "a bound without rows");
}

#[test]
fn rows_of_a_furnished_room_reach_one_at_any_opening() {
    // One room without doors: closed, with seventeen boxes in it.
    let geometry = fine(&levels::furnished(1)[0], 0.3);
    for tolerance in [0.3, 0.03, 0.003, 0.0] {
        let block = coupling(&alone(&geometry), 0, &[0], Resolution::for_tolerance(tolerance));
        let worst = (0..block.receivers()).map(|i| (block.row_sum(i) - 1.0).abs()).fold(0.0, f64::max);
        // Exact rows stop when 1e-12 is missing, others at 1e-6 and in steps of about as much.
        let allowed = if tolerance == 0.0 { 2e-12 } else { 1e-5 };
        assert!(worst <= allowed, "tolerance {tolerance}: a row is {worst} from one");
    }
}
