//! Whole furnished levels: what a row costs, takes and misses, and by how much the light errs.
//!
//! `cargo bench -p equilux-tests --bench levels -- ROOMS SIZE OPENING…`, such as `6 0.25 0 1e-2 1e-3`: rooms, element
//! size in metres, and openings of the treecode, 0 for the exact matrix. The error of the light is against the first.

use equilux_bake::treecode::{EXACT, Resolution};
use equilux_formats::{Precision, Rgb};
use equilux_tests::measure::Level;
use std::time::Instant;

fn main() {
    let numbers: Vec<f64> = std::env::args().skip(1).filter_map(|a| a.parse().ok()).collect();
    let [rooms, size, ref openings @ ..] = numbers[..] else {
        println!("usage: levels ROOMS SIZE OPENING…");
        return;
    };
    let level = Level::furnished(rooms as usize, size);
    println!("{rooms} rooms, {} elements, {} faces", level.world.elements.len(), level.world.faces.len());
    println!(
        "{:>8} {:>10} {:>12} {:>12} {:>10} {:>8} {:>8}",
        "opening", "µs a row", "entries", "B a row", "defect", "error %", "wall s"
    );
    let mut reference = None;
    for &opening in openings {
        measure(&level, opening, &mut reference);
    }
}

fn measure(level: &Level, opening: f64, reference: &mut Option<Vec<Rgb>>) {
    let resolution = if opening == 0.0 { EXACT } else { Resolution { opening, precision: Precision::Steps } };
    let start = Instant::now();
    let rows = level.rows(resolution);
    let wall = start.elapsed().as_secs_f64();
    let radiosity = level.radiosity(&rows.blocks, 1e-6);
    let error = level.difference(&radiosity, reference.get_or_insert_with(|| radiosity.clone()));
    let count = level.world.elements.len() as f64;
    let stored: usize = rows.blocks.iter().map(|b| b.stored()).sum();
    let bytes: usize = rows.blocks.iter().map(|b| b.bytes()).sum();
    println!(
        "{opening:>8.0e} {:>10.1} {:>12.0} {:>12.0} {:>10.0e} {:>8.3} {wall:>8.2}",
        rows.time.as_secs_f64() * 1e6 / count,
        stored as f64 / count,
        bytes as f64 / count,
        rows.defect,
        error * 100.0,
    );
}
