//! Whole levels: rows, memory and error of the treecode. `cargo bench -p equilux-tests --bench levels -- ROOMS SIZE OPENING…`

use equilux_bake::elements::{ElementSize, optics, subdivide};
use equilux_bake::monitor::Monitor;
use equilux_bake::treecode::{EXACT, Request, Resolution, block};
use equilux_bake::world::World;
use equilux_formats::{Geometry, Precision};
use equilux_tests::levels::furnished;
use glam::DAffine3;
use std::time::Instant;

fn main() {
    let numbers: Vec<f64> = std::env::args().skip(1).filter_map(|a| a.parse().ok()).collect();
    let [rooms, size, ref openings @ ..] = numbers[..] else {
        println!("usage: ROOMS SIZE OPENING…");
        return;
    };
    let parts = furnished(rooms as usize);
    let geometries: Vec<Geometry> = parts.iter().map(|p| subdivide(p, ElementSize::Metres(size))).collect();
    let _ = optics(&geometries[0], &parts[0].materials);
    let start = Instant::now();
    let world = World::new(geometries.iter().map(|g| (g, DAffine3::IDENTITY)));
    println!(
        "{} elements, {} faces, {} occluders, world {:.3} s",
        world.elements.len(),
        world.faces.len(),
        world.occluders.all.len(),
        start.elapsed().as_secs_f64()
    );
    let everyone: Vec<usize> = (0..world.instances()).collect();
    for &opening in openings {
        let resolution =
            if opening == 0.0 { EXACT } else { Resolution { opening, precision: Precision::Steps } };
        let start = Instant::now();
        let (mut time, mut stored, mut bytes, mut worst) = (0.0, 0, 0, 0.0f64);
        for &receivers in &everyone {
            let request = Request {
                world: &world,
                receivers,
                senders: &everyone,
                columns: 0..world.nodes.len(),
                already: None,
                resolution,
            };
            let timed = block(&request, &Monitor::default()).expect("runs");
            time += timed.time.as_secs_f64();
            stored += timed.block.stored();
            bytes += timed.block.bytes();
            let (i, sum) = timed
                .row_sums
                .iter()
                .enumerate()
                .max_by(|a, b| (a.1 - 1.0).abs().total_cmp(&(b.1 - 1.0).abs()))
                .unwrap();
            if (sum - 1.0).abs() > worst {
                worst = (sum - 1.0).abs();
                println!(
                    "  worst {} at {:?} n {:?}",
                    sum,
                    world.elements[world.elements_of(receivers).start + i].centroid,
                    world.elements[world.elements_of(receivers).start + i].normal
                );
            }
        }
        let n = world.elements.len() as f64;
        println!(
            "opening {opening:e}: {:.1} µs a row, {:.0} entries a row, {:.0} B an element, worst row {worst:.1e}, wall {:.2}",
            time * 1e6 / n,
            stored as f64 / n,
            bytes as f64 / n,
            start.elapsed().as_secs_f64()
        );
    }
}
