//! The dense matrix of the whole scene, F_ij for every pair of elements in f64, and the solution of (I − ρF) B = E.
//! Goral, Torrance, Greenberg & Battaile 1984.

use super::rays;
use equilux_bake::equilibrium::endless::endless_light;
use equilux_bake::equilibrium::krylov::gmres;
use equilux_bake::monitor::Monitor;
use equilux_bake::rays::RayIndex;
use equilux_bake::treecode::{Audience, exact_rows};
use equilux_bake::world::World;
use equilux_formats::{Element, Error, Optics, Result, Rgb};
use rayon::prelude::*;
use std::time::{Duration, Instant};

/// Relative residual at which the solver ends: the bound that the exchange proves by default.
const RESIDUAL_TOLERANCE: f64 = 1e-6;

/// Number of rows that are computed together.
const BATCH_ROWS: usize = 512;

/// The matrix.
pub struct Dense {
    size: usize,
    /// By rows, `size × size`.
    values: Vec<f64>,
    /// Time spent on form factors, summed over threads.
    pub time: Duration,
}

impl Dense {
    /// The exact matrix. Fails if the monitor was stopped.
    pub fn exact(world: &World, monitor: &Monitor) -> Result<Self> {
        let size = world.elements.len();
        let element: Vec<Option<usize>> = (0..world.nodes.len()).map(|node| world.element_of(node)).collect();
        let mut matrix = Self { size, values: vec![0.0; size * size], time: Duration::ZERO };
        let places: Vec<usize> = (0..size).collect();
        for rows in places.chunks(BATCH_ROWS) {
            let receivers = Audience::Points(&world.elements[rows[0]..rows[0] + rows.len()]);
            let timed = exact_rows(world, receivers, monitor)?;
            matrix.time += timed.time;
            for (k, &i) in rows.iter().enumerate() {
                let row = &mut matrix.values[i * size..(i + 1) * size];
                for (node, value) in timed.block.row(k) {
                    row[element[node].expect("an exact row names elements")] = value;
                }
            }
        }
        Ok(matrix)
    }

    /// The matrix with sampled visibility, `count` rays for each pair. Fails if the monitor was stopped.
    pub fn by_rays(elements: &[Element], count: usize, monitor: &Monitor) -> Result<Self> {
        let size = elements.len();
        let index = RayIndex::new(elements);
        monitor.begin("rays", size, size as f64);
        let row = |i: usize| {
            let start = Instant::now();
            let row = if monitor.stopped() { vec![] } else { rays::row(elements, &index, i, count) };
            monitor.advance(1);
            (row, start.elapsed())
        };
        let (rows, times): (Vec<Vec<f64>>, Vec<Duration>) = (0..size).into_par_iter().map(row).unzip();
        let matrix = Self { size, values: rows.concat(), time: times.iter().sum() };
        if monitor.stopped() { Err(Error::Stopped) } else { Ok(matrix) }
    }

    /// Size of the matrix, bytes.
    pub fn bytes(&self) -> usize {
        self.values.len() * size_of::<f64>()
    }

    /// Whether some elements see only each other, absorb nothing, and emit, so that there is no solution.
    pub fn is_endless(&self, optics: &Optics) -> bool {
        let row = |i: usize| -> Vec<(usize, f64)> {
            let row = self.values[i * self.size..(i + 1) * self.size].iter().copied();
            row.enumerate().filter(|&(_, value)| value != 0.0).collect()
        };
        endless_light(optics, row).is_some()
    }

    /// H = F B, W/m².
    pub fn irradiance(&self, radiosity: &[Rgb]) -> Vec<Rgb> {
        let gathered =
            |row: &[f64]| row.iter().zip(radiosity).fold(Rgb::BLACK, |sum, (&f, b)| sum + b.map(|b| f * b));
        // Chunks of length 0 are not allowed, and a scene may be empty.
        self.values.par_chunks(self.size.max(1)).map(gathered).collect()
    }

    /// B = E + ρ F B, W/m².
    pub fn solve(&self, optics: &Optics) -> Vec<Rgb> {
        let Optics { reflectance, emission } = optics;
        let without_reflection = |b: &[Rgb]| -> Vec<Rgb> {
            let irradiance = self.irradiance(b);
            (0..b.len()).map(|i| b[i] - reflectance[i] * irradiance[i]).collect()
        };
        let mut radiosity = emission.clone();
        gmres(without_reflection, |r| r.to_vec(), emission, &mut radiosity, RESIDUAL_TOLERANCE);
        radiosity
    }
}
