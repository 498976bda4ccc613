//! Compares each scene with the result of a path tracer, which states its noise as standard errors.
//! `scenes/<name>/truth.csv` has one line an element; `scenes/README.md` describes its columns.

mod points;
mod target;
mod texels;

use equilux_assemble::outputs::requests::Pictures;
use equilux_assemble::proof::sample::ExactRows;
use equilux_assemble::run::job::Job;
use equilux_assemble::run::run;
use equilux_bake::elements::ElementSize;
use equilux_bake::monitor::Monitor;
use equilux_bake::oven::prepare::{Division, Preparation, RowMethod};
use equilux_bake::treecode::EXACT;
use equilux_tests::table::Table;
use equilux_tests::truth::{Errors, gathered, places};
use std::path::{Path, PathBuf};

/// Largest difference between a path tracer and collocation at centroids, without noise: collocation takes the light
/// within a sender to be constant. Measured: 0.35 % to 0.83 %.
const TOLERANCE: f64 = 0.01;

#[test]
fn wood_is_lit_as_path_tracing_lights_it() {
    agrees("wood");
}

#[test]
fn shadow_is_lit_as_path_tracing_lights_it() {
    agrees("shadow");
}

#[test]
fn cornell_is_lit_as_path_tracing_lights_it() {
    agrees("cornell");
}

#[test]
fn corridor_is_lit_as_path_tracing_lights_it() {
    agrees("corridor");
}

fn agrees(name: &str) {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenes").join(name);
    let truth = Table::read(&folder.join("truth.csv"));
    let ours = assembled(&folder.join(name).with_extension("glb"));
    let found = gathered(&truth, places(&ours), |row| {
        (ours.number(row, "area"), ["H_r", "H_g", "H_b"].map(|colour| ours.number(row, colour)))
    });
    for (channel, colour) in ["r", "g", "b"].iter().enumerate() {
        let at_centroids =
            Errors::of(&truth, &found, ["Hc", "Hc_se"].map(|k| format!("{k}_{colour}")), channel);
        let averages = Errors::of(&truth, &found, ["Ha", "Ha_se"].map(|k| format!("{k}_{colour}")), channel);
        println!("{name} {colour}: {at_centroids}; averages over elements: {averages}");
        assert!(
            at_centroids.net() <= TOLERANCE,
            "{name}, channel {colour}: irradiance is {at_centroids} off, more than {TOLERANCE}"
        );
    }
}

/// The scene's elements with their light, each face of its mesh one element.
fn assembled(scene: &Path) -> Table {
    let folder = tempfile::tempdir().unwrap();
    let elements: PathBuf = folder.path().join("elements.csv");
    let mut job = Job::new(scene.to_path_buf());
    job.settings.cache = folder.path().join("cache");
    job.outputs.folder = folder.path().join("out");
    job.settings.preparation = Preparation {
        resolution: EXACT,
        element_size: Some(ElementSize::Mesh),
        division: Division::Authored,
        rows: RowMethod::Exact,
        rays: 256,
        local_solver: None,
    };
    job.outputs.exact_rows = Some(ExactRows::About(0));
    job.outputs.pictures = Pictures::None;
    job.outputs.elements = Some(elements.clone());
    let report = run(&job, &Monitor::default()).unwrap();
    assert!(report.converged, "the exchange ended without the error asked for: {:?}", report.rounds.last());
    Table::read(&elements)
}
