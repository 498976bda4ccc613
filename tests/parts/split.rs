//! The light of a scene made of parts is the light of the classic whole-scene matrix, with parts as authored and with
//! cells between planes anywhere.

use equilux_assemble::exchange::settings::Method;
use equilux_assemble::run::job::Job;
use equilux_bake::elements::bisect::Cut;
use equilux_bake::oven::prepare::Division;
use equilux_tests::rooms::furnished;
use equilux_tests::workshop::{Workshop, assembled, changed};
use proptest::prelude::*;

/// Both sides solve the same equation down to rounding, some 1e-14 of the brightest radiosity; the darkest elements of
/// these rooms have a thousandth of it. Wrong visibility anywhere costs 1e-3 and more.
const ROUNDING: f64 = 1e-10;

/// Polygons of a closed scene fill a receiver's whole view. Each of some hundred edge terms is rounded at 1e-16; clipped
/// slivers cost more.
const CLOSED: f64 = 1e-12;

fn agrees_with_the_whole(job: &Job) {
    let report = assembled(&changed(job.clone(), |job| {
        job.outputs.verify = true;
    }));
    let difference = report.verify.as_ref().expect("a comparison").max_rel_diff;
    let what = format!("{:?}, {:?}", job.settings.preparation.division, job.settings.method);
    assert!(difference <= ROUNDING, "{what}: {difference:e} away from the whole, more than {ROUNDING:e}");
    let defect = report.row_sum_defect.max;
    assert!(
        defect <= CLOSED,
        "{what}: a row of this closed scene sums to 1 ± {defect:e}, more than {CLOSED:e}"
    );
    assert!(report.converged, "{what}: not converged, {:?}", report.rounds.last());
}

#[test]
fn authored_parts_each_with_its_own_solver_are_the_whole() {
    let workshop = Workshop::with(&furnished());
    for method in [Method::Jacobi, Method::GaussSeidel] {
        let mut job = workshop.job(Division::Authored);
        job.settings.method = method;
        agrees_with_the_whole(&job);
    }
    let report = assembled(&workshop.job(Division::Authored));
    let solvers: Vec<&str> = report.parts.iter().map(|part| part.local_solver.as_str()).collect();
    // Of crate, light, table and walls.
    assert_eq!(solvers, ["Iterative", "Progressive", "GaussSeidel", "Direct"], "what the extras ask for");
}

/// A plane anywhere in the room, often along walls, tabletops and the edges of elements.
fn plane() -> impl Strategy<Value = Cut> {
    let offset = prop_oneof![(0..32).prop_map(|eighths| f64::from(eighths) / 8.0), 0.0..4.0];
    (0..3usize, offset).prop_map(|(axis, offset)| Cut { axis, offset })
}

proptest! {
    // Six scenes of half a second; a failure is shown as it was found, for shrinking would take minutes.
    #![proptest_config(ProptestConfig { cases: 6, max_shrink_iters: 0, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn cells_between_any_planes_are_the_whole(planes in proptest::collection::vec(plane(), 1..5)) {
        agrees_with_the_whole(&Workshop::with(&furnished()).job(Division::Cuts(planes)));
    }
}
