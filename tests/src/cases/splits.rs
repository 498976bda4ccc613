//! Parts and the whole are one equation: the same light however a scene is divided, solved, ordered and computed.

use super::solve::{Setting, light};
use super::{Case, Finding};
use crate::rooms::{echoing, furnished};
use crate::workshop::{Workshop, assembled, changed};
use equilux_assemble::exchange::settings::Method;
use equilux_bake::oven::prepare::Division;
use equilux_formats::LocalSolver;
use rayon::ThreadPoolBuilder;

/// The cases.
pub fn cases() -> Vec<Case> {
    let rounding =
        "both solve one equation down to 1e-14 of the brightest; the darkest have a thousandth of that";
    vec![
        Case::new("2 parts are the whole", 1e-10, rounding, || every_way(2)),
        Case::new("8 parts are the whole", 1e-10, rounding, || every_way(8)),
        Case::new("32 parts are the whole", 1e-10, rounding, || every_way(32)),
        Case::new(
            "rows in 32 parts sum to 1",
            1e-12,
            "hundreds of edge terms of 1e-16; slivers cost more",
            || light(&furnished(), &Setting::metres(1.0).cut(32)).row_sums(),
        ),
        Case::new("32 parts are the whole, ρ = 0.99", 1e-10, rounding, || {
            let solved = light(&echoing(0.01), &Setting::metres(1.0).cut(32).verified());
            difference(solved.report.verify.as_ref().map(|v| v.max_rel_diff)).after(solved.rounds())
        }),
        Case::new(
            "parts in another order",
            1e-11,
            "sums in another order, the darkest a thousandth",
            reordered,
        ),
        Case::new("1, 2 and 5 threads", 0.0, "no sum depends on who computes it", threads),
    ]
}

fn difference(found: Option<f64>) -> Finding {
    let found = found.expect("a comparison");
    Finding::of("the whole-scene solution", format!("{found:.1e} away"), found)
}

/// All local solvers, and both of the paper's methods, on one division. The cache is shared: what is compared is the solution.
fn every_way(cells: usize) -> Finding {
    let workshop = Workshop::with(&furnished());
    let mut job = workshop.job(Division::Bisect(cells));
    job.outputs.verify = true;
    use LocalSolver::*;
    let solvers = [Direct, GaussSeidel, Progressive, Iterative].map(|solver| {
        changed(job.clone(), |job| {
            job.settings.preparation.local_solver = Some(solver);
        })
    });
    let methods = [Method::Jacobi, Method::GaussSeidel].map(|method| {
        changed(job.clone(), |job| {
            job.settings.method = method;
        })
    });
    Finding::worst(solvers.iter().chain(&methods).map(|job| {
        let report = assembled(job);
        assert!(report.converged, "{:?}: {:?}", job.settings.method, report.rounds.last());
        difference(report.verify.map(|verify| verify.max_rel_diff)).after(Some(report.rounds.len()))
    }))
}

fn reordered() -> Finding {
    let sorted = |nodes: &[_]| {
        let mut elements = light(nodes, &Setting::metres(0.5)).elements;
        let key = |p: &super::solve::Lit| [p.centroid.to_array(), p.normal.to_array()].concat();
        elements.sort_by(|a, b| key(a).partial_cmp(&key(b)).expect("no NaN"));
        elements
    };
    let mut nodes = furnished();
    let one = sorted(&nodes);
    nodes.reverse();
    let other = sorted(&nodes);
    Finding::worst_relative(one.iter().zip(&other).map(|(a, b)| (a.radiosity[0], b.radiosity[0])))
}

fn threads() -> Finding {
    let with = |threads: usize| {
        let pool = ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
        pool.install(|| light(&echoing(0.1), &Setting::metres(0.5).cut(8)))
    };
    let one = with(1);
    Finding::worst([2, 5].map(|threads| {
        let many = with(threads);
        let pairs = one.elements.iter().zip(&many.elements);
        Finding::worst_relative(pairs.map(|(a, b)| (a.radiosity[0], b.radiosity[0]))).after(many.rounds())
    }))
}
