//! Whole furnished levels: what a row costs, takes and misses.
//!
//! `cargo bench -p equilux-tests --bench levels -- ROOMS SIZE OPENING…`, such as `6 0.25 1e-2 1e-3 0`: rooms, element size
//! in metres, and openings of the treecode, 0 for the exact matrix.

use equilux_bake::elements::{ElementSize, subdivide};
use equilux_bake::monitor::Monitor;
use equilux_bake::treecode::{EXACT, Request, Resolution, Timed, block};
use equilux_bake::world::World;
use equilux_formats::{Geometry, Precision};
use equilux_tests::levels::furnished;
use glam::DAffine3;
use std::time::Instant;

fn main() {
    let numbers: Vec<f64> = std::env::args().skip(1).filter_map(|a| a.parse().ok()).collect();
    let [rooms, size, ref openings @ ..] = numbers[..] else {
        println!("usage: levels ROOMS SIZE OPENING…");
        return;
    };
    let parts = furnished(rooms as usize);
    let geometries: Vec<Geometry> = parts.iter().map(|p| subdivide(p, ElementSize::Metres(size))).collect();
    let world = World::new(geometries.iter().map(|g| (g, DAffine3::IDENTITY)));
    println!("{rooms} rooms, {} elements, {} faces", world.elements.len(), world.faces.len());
    println!(
        "{:>8} {:>10} {:>12} {:>12} {:>10} {:>8}",
        "opening", "µs a row", "entries", "B a row", "defect", "wall s"
    );
    for &opening in openings {
        measure(&world, opening);
    }
}

fn measure(world: &World, opening: f64) {
    let resolution = if opening == 0.0 { EXACT } else { Resolution { opening, precision: Precision::Steps } };
    let everyone: Vec<usize> = (0..world.instances()).collect();
    let start = Instant::now();
    let (mut seconds, mut stored, mut bytes, mut defect) = (0.0, 0, 0, 0.0f64);
    for &receivers in &everyone {
        let columns = 0..world.nodes.len();
        let request = Request { world, receivers, senders: &everyone, columns, already: None, resolution };
        let Timed { block, row_sums, time } = block(&request, &Monitor::default()).expect("nobody stops it");
        seconds += time.as_secs_f64();
        stored += block.stored();
        bytes += block.bytes();
        defect = row_sums.iter().map(|sum| (sum - 1.0).abs()).fold(defect, f64::max);
    }
    let rows = world.elements.len() as f64;
    println!(
        "{opening:>8.0e} {:>10.0} {:>12.0} {:>12.0} {defect:>10.0e} {:>8.2}",
        seconds * 1e6 / rows,
        stored as f64 / rows,
        bytes as f64 / rows,
        start.elapsed().as_secs_f64()
    );
}
