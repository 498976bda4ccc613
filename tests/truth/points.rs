//! Light gathered at the truth's points from elements of the default size, which are unrelated to the truth's.

use equilux_assemble::outputs::requests::Pictures;
use equilux_assemble::run::run;
use equilux_bake::monitor::Monitor;
use equilux_bake::oven::prepare::{Division, Preparation, RowMethod};
use equilux_bake::treecode::Resolution;
use equilux_tests::table::Table;
use equilux_tests::truth::{Errors, Found};
use equilux_tests::workshop::Workshop;
use std::path::Path;

/// RMS error relative to the mean, without the truth's noise: radiosity is constant over each sender, and form factors
/// have a tolerance of 1 %. Measured: 0.61 % to 0.87 %.
const TOLERANCE: f64 = 0.01;

#[test]
fn light_at_points_is_that_of_path_tracing_whatever_the_elements() {
    for name in ["wood", "shadow", "cornell", "corridor"] {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenes").join(name);
        let workshop = Workshop::new();
        let resolution = Resolution::for_tolerance(0.01);
        let division = Division::Authored;
        let mut job = workshop.job(Division::Authored);
        job.scene = folder.join(name).with_extension("glb");
        job.settings.preparation = Preparation {
            element_size: None,
            division,
            resolution,
            rows: RowMethod::Exact,
            rays: 256,
            local_solver: None,
        };
        job.outputs.pictures = Pictures::None;
        job.outputs.points = Some(folder.join("truth.csv"));
        run(&job, &Monitor::default()).expect("a run");
        let off = off(&folder, &workshop.path("out").join(name).join("points.csv"));
        assert!(off <= TOLERANCE, "{name}: {off} off, more than {TOLERANCE}");
    }
}

/// How far light at the points of a scene's truth is from it, the noise taken out; the worst channel.
pub fn off(folder: &Path, points: &Path) -> f64 {
    let (truth, ours) = (Table::read(&folder.join("truth.csv")), Table::read(points));
    let area = |row: usize| truth.number(row, "area");
    let found = |row: usize| Found {
        area: area(row),
        power: ["H_r", "H_g", "H_b"].map(|column| area(row) * ours.number(row, column)),
    };
    let found: Vec<Found> = (0..truth.rows()).map(found).collect();
    let of = |(channel, colour): (usize, &str)| {
        let columns = ["Hc", "Hc_se"].map(|k| format!("{k}_{colour}"));
        Errors::of(&truth, &found, columns, channel).net()
    };
    ["r", "g", "b"].into_iter().enumerate().map(of).fold(0.0, f64::max)
}
