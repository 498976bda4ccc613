//! Rows by rays: physics in closed rooms, then what a cache, threads and edits may and may not change.

mod edits;
mod kept;
mod light;
mod openings;
mod split;

use equilux_assemble::SolveSettings;
use equilux_assemble::equation::environment::Environment;
use equilux_assemble::exchange::listener::Unobserved;
use equilux_assemble::solve::{Solved, solve_prepared};
use equilux_bake::elements::ElementSize;
use equilux_bake::monitor::Monitor;
use equilux_bake::oven::prepare::{RowMethod, prepare};
use equilux_bake::treecode::EXACT;
use equilux_formats::{Scene, Store};

/// The light of a scene by so many rays a row, with elements of `size` metres.
pub fn solved(scene: &Scene, size: f64, rays: u32) -> Solved {
    method(scene, size, RowMethod::Rays, rays)
}

/// The light of a scene, by so many rays a row or by exact rows without clusters, with elements of `size` metres.
pub fn method(scene: &Scene, size: f64, rows: RowMethod, rays: u32) -> Solved {
    let folder = tempfile::tempdir().expect("a folder");
    let mut settings = SolveSettings { cache: folder.path().into(), ..SolveSettings::default() };
    let preparation = &mut settings.preparation;
    preparation.element_size = Some(ElementSize::Metres(size));
    (preparation.rows, preparation.rays) = (rows, rays);
    preparation.resolution = EXACT;
    let prepared = prepare(scene, &settings.preparation).expect("elements");
    let store = Store::open(folder.path()).expect("a cache");
    let environment = Environment::read(None, None).expect("no sky");
    let monitor = Monitor::default();
    solve_prepared(scene, prepared, &environment, &settings, &store, &monitor, &Unobserved).expect("light")
}
