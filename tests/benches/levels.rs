//! Whole furnished levels: time, memory and defect of a row, and the error of the light. Then the same with rays.
//!
//! `cargo bench -p equilux-tests --bench levels -- ROOMS SIZE OPENING…`, such as `6 0.25 0 1e-3`: rooms, element size in
//! metres, and openings of the treecode, 0 for the exact matrix. Errors are against the first.

use equilux_bake::treecode::{EXACT, Resolution};
use equilux_formats::Rgb;
use equilux_formats::rows::Precision;
use equilux_tests::measure::Level;
use std::time::Instant;

/// Rays a pair, and rows that are cast.
const RAYS: ([usize; 3], usize) = ([1, 4, 16], 48);

fn main() {
    let numbers: Vec<f64> = std::env::args().skip(1).filter_map(|a| a.parse().ok()).collect();
    let [rooms, size, ref openings @ ..] = numbers[..] else {
        println!("usage: levels ROOMS SIZE OPENING…");
        return;
    };
    let level = Level::furnished(rooms as usize, size);
    println!("{rooms} rooms, {} elements, {} faces", level.world.elements.len(), level.world.faces.len());
    println!(
        "{:>9} {:>10} {:>9} {:>9} {:>8} {:>8} {:>8}",
        "opening", "µs a row", "entries", "B a row", "defect", "error %", "wall s"
    );
    let mut reference = None;
    for &opening in openings {
        measure(&level, opening, &mut reference);
    }
    if openings.first() == Some(&0.0) {
        cast(&level, reference.as_ref().expect("the exact matrix was first"));
    }
}

/// The light, and the irradiance of some receivers.
struct Reference {
    radiosity: Vec<Rgb>,
    gathered: Vec<f64>,
}

fn measure(level: &Level, opening: f64, reference: &mut Option<Reference>) {
    let resolution =
        if opening == 0.0 { EXACT } else { Resolution { opening, precision: Precision::Single, rays: None } };
    let start = Instant::now();
    let rows = level.rows(resolution);
    let wall = start.elapsed().as_secs_f64();
    let radiosity = level.radiosity(&rows.blocks, 1e-6);
    let first = || {
        let gathered = level.gathered(&rows.blocks, &radiosity, &level.sample(RAYS.1));
        Reference { radiosity: radiosity.clone(), gathered }
    };
    let error = level.difference(&radiosity, &reference.get_or_insert_with(first).radiosity);
    let count = level.world.elements.len() as f64;
    let stored: usize = rows.blocks.iter().map(|b| b.stored()).sum();
    let bytes: usize = rows.blocks.iter().map(|b| b.bytes()).sum();
    println!(
        "{opening:>9.0e} {:>10.1} {:>9.0} {:>9.0} {:>8.0e} {:>8.3} {wall:>8.2}",
        rows.time.as_secs_f64() * 1e6 / count,
        stored as f64 / count,
        bytes as f64 / count,
        rows.defect,
        error * 100.0,
    );
}

/// Dense rows by rays: one f32 value a pair, and the error of the irradiance.
fn cast(level: &Level, reference: &Reference) {
    let count = level.world.elements.len();
    for rays in RAYS.0 {
        let cast = level.cast(level.sample(RAYS.1), rays);
        let defect = cast.rows.iter().map(|row| (row.iter().sum::<f64>() - 1.0).abs()).fold(0.0, f64::max);
        let error = level.gather_error(&cast, &reference.radiosity, &reference.gathered);
        println!(
            "{:>9} {:>10.1} {count:>9} {:>9} {defect:>8.0e} {:>8.3}",
            format!("{rays} rays"),
            cast.time.as_secs_f64() * 1e6 / RAYS.1 as f64,
            count * size_of::<f32>(),
            error * 100.0,
        );
    }
}
