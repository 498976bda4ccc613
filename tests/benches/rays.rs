//! Rows by rays in furnished levels: microseconds a row, rays a second, entries, and rays that end nowhere.
//!
//! `cargo bench -p equilux-tests --bench rays -- ROOMS SIZE RAYS`, such as `32 0.3 256`: rooms, element size in metres, and rays
//! a row. Every room is a part, traced alone and then in the level.

use equilux_bake::monitor::Monitor;
use equilux_bake::rays::alone::alone;
use equilux_bake::rays::counts::{SceneColumns, placed};
use equilux_bake::rays::samples::Samples;
use equilux_bake::rays::scenery::Scenery;
use equilux_bake::rays::surfaces::Surfaces;
use equilux_formats::Rows;
use equilux_tests::measure::Level;
use glam::DAffine3;
use std::sync::Arc;
use std::time::Instant;

fn main() {
    let numbers: Vec<f64> = std::env::args().skip(1).filter_map(|a| a.parse().ok()).collect();
    let [rooms, size, rays] = numbers[..] else {
        println!("usage: rays ROOMS SIZE RAYS");
        return;
    };
    let one_thread = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("a thread");
    one_thread.install(|| measure(&Level::furnished(rooms as usize, size), rays as u32));
}

fn measure(level: &Level, rays: u32) {
    let monitor = Monitor::default();
    let start = Instant::now();
    let surfaces: Vec<Arc<Surfaces>> =
        level.geometries.iter().map(|geometry| Arc::new(Surfaces::new(geometry))).collect();
    let scenery = Scenery::new(surfaces.iter().map(|surfaces| (surfaces.clone(), DAffine3::IDENTITY)));
    let samples = Samples::new(rays);
    let setup = start.elapsed().as_secs_f64();
    let start = Instant::now();
    let baked: Vec<_> =
        surfaces.iter().map(|own| alone(own, &samples, &monitor).expect("not stopped")).collect();
    let baking = start.elapsed().as_secs_f64();
    let start = Instant::now();
    let first: Vec<u32> = (0..surfaces.len()).map(|k| level.world.elements_of(k).start as u32).collect();
    let unknowns = level.world.elements.len();
    let columns = SceneColumns { first: &first, unknowns, cells: 1, cell: &|_| 0 };
    let (mut stored, mut escaped, mut traced, mut lack) = (0, 0, 0, 0.0);
    for (k, baked) in baked.iter().enumerate() {
        let alone = (&baked.self_block, &baked.escapes);
        let rows = placed(&scenery, &samples, k, alone, columns, &monitor).expect("not stopped");
        let own = rows.self_block.as_ref().unwrap_or(&baked.self_block);
        stored += own.stored() + rows.others.stored();
        traced += rows.traced.iter().map(|&rays| rays as usize).sum::<usize>();
        let sum = |i: usize| own.row_sum(i) + rows.others.row_sum(i);
        lack += (0..own.receivers()).map(|i| 1.0 - sum(i)).sum::<f64>();
        escaped += sky(&rows.others, unknowns);
    }
    let coupling = start.elapsed().as_secs_f64();
    let per = |seconds: f64| seconds * 1e6 / unknowns as f64;
    println!(
        "{} rooms, {unknowns} elements, R = {rays}: setup {setup:.2} s; {:.1} µs a row alone + {:.1} in the level, {:.2} Mrays/s \
         alone; {:.1} % traced again; {:.0} entries; {escaped} escaped, {:.1e} of a row not on elements",
        surfaces.len(),
        per(baking),
        per(coupling),
        f64::from(rays) * unknowns as f64 / baking / 1e6,
        100.0 * traced as f64 / (f64::from(rays) * unknowns as f64),
        stored as f64 / unknowns as f64,
        lack / unknowns as f64,
    );
}

/// Entries of the sky.
fn sky(rows: &Rows, unknowns: usize) -> usize {
    (0..rows.receivers()).flat_map(|i| rows.row(i)).filter(|&(column, _)| column >= unknowns).count()
}
