//! What texels of the size of a path tracer's elements cost and how far they are from its averages.
//! `cargo bench -p equilux-tests --bench texels -- SCENE.glb FINE.glb TRUTH.csv [ELEMENT SIZE] [TOLERANCE]`

use equilux_bake::elements::ElementSize;
use equilux_bake::gltf_import::import_scene;
use equilux_bake::prepare::{Division, Preparation, prepare};
use equilux_bake::treecode::Resolution;
use equilux_bake::world::World;
use equilux_tests::averages::averages;
use equilux_tests::lit::lit;
use equilux_tests::table::Table;
use std::path::Path;
use std::time::Instant;

fn cpu() -> f64 {
    let stat = std::fs::read_to_string("/proc/self/stat").unwrap_or_default();
    let fields: Vec<&str> = stat.rsplit(')').next().unwrap_or("").split_whitespace().collect();
    let ticks = |n: usize| fields.get(n).and_then(|t| t.parse::<f64>().ok()).unwrap_or(0.0);
    (ticks(11) + ticks(12)) / 100.0
}

fn main() {
    let args: Vec<String> = std::env::args().skip(1).filter(|a| a != "--bench").collect();
    let [scene, fine, truth] = [0, 1, 2].map(|k| Path::new(&args[k]));
    let number = |k: usize, default: f64| args.get(k).and_then(|a| a.parse().ok()).unwrap_or(default);
    let (size, tolerance) = (number(3, 0.5), number(4, 0.01));
    let resolution = Resolution::for_tolerance(tolerance);
    let wanted = |element_size| Preparation {
        element_size: Some(element_size),
        division: Division::Authored,
        resolution,
        local_solver: None,
    };
    let table = Table::read(truth);
    let prepared = prepare(&import_scene(fine).unwrap(), &wanted(ElementSize::Mesh)).unwrap();
    let world = World::new(
        prepared.instances.iter().map(|i| (&prepared.parts[i.part.index()].geometry, i.placement)),
    );
    let (start, cpu0) = (Instant::now(), cpu());
    let lit = lit(scene, &wanted(ElementSize::Metres(size)));
    let (solved, cpu1) = (start.elapsed().as_secs_f64(), cpu());
    let found = averages(&lit, &world.elements, resolution);
    let (all, cpu2) = (start.elapsed().as_secs_f64(), cpu());
    println!(
        "{} elements, {} texels; CPU-s: solve {:.2}, texels {:.2}; wall {solved:.2}, {:.2}",
        lit.placed.world.elements.len(),
        found.len(),
        cpu1 - cpu0,
        cpu2 - cpu1,
        all - solved
    );
    let (centroids, normals) = (table.vectors(["x", "y", "z"]), table.vectors(["nx", "ny", "nz"]));
    let mut sums = vec![([0.0; 3], 0.0); table.rows()];
    for (element, light) in world.elements.iter().zip(&found) {
        let owner = (0..table.rows())
            .filter(|&i| normals[i].dot(element.normal) > 0.99)
            .min_by(|&a, &b| {
                centroids[a]
                    .distance_squared(element.centroid)
                    .total_cmp(&centroids[b].distance_squared(element.centroid))
            })
            .unwrap();
        for c in 0..3 {
            sums[owner].0[c] += light[c] * element.area;
        }
        sums[owner].1 += element.area;
    }
    for (c, colour) in ["r", "g", "b"].iter().enumerate() {
        let (mut mean, mut off, mut noise, mut area) = (0.0, 0.0, 0.0, 0.0);
        let mut worst = (0.0, 0);
        for (row, (power, own)) in sums.iter().enumerate() {
            let expected = table.number(row, &format!("Ha_{colour}"));
            let d = power[c] / own - expected;
            if d.abs() > worst.0 {
                worst = (d.abs(), row);
            }
            mean += own * expected;
            area += own;
            off += own * d * d;
            noise += own * table.number(row, &format!("Ha_se_{colour}")).powi(2);
        }
        let w = worst.1;
        println!(
            "{colour}: RMSE {:.2} %, noise {:.2} %, mean {:.3}; worst {:.3} at {} normal {} truth {:.4}",
            100.0 * (off / area).sqrt() / (mean / area),
            100.0 * (noise / area).sqrt() / (mean / area),
            mean / area,
            worst.0,
            centroids[w],
            normals[w],
            table.number(w, &format!("Ha_{colour}"))
        );
    }
}
