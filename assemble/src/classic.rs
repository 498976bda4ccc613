//! The classic matrix radiosity of the whole scene, on the same elements: what the parts must agree with.

use crate::placed::Placed;
use equilux_bake::equilibrium::{LocalSystem, default_solver, factorise};
use equilux_bake::form_factor::block::block;
use equilux_bake::monitor::Monitor;
use equilux_formats::{Optics, Rgb, Rows};
use std::time::{Duration, Instant};

/// The whole-scene answer and what it took.
pub struct Classic {
    /// Radiosity of all elements.
    pub radiosity: Vec<Rgb>,
    /// The whole matrix.
    pub matrix: Rows,
    /// Time spent on form factors, summed over threads.
    pub form_factor_time: Duration,
    /// Time spent on the solution.
    pub solve_time: Duration,
}

/// Compute the whole matrix at once and solve it at once. None if the monitor was stopped.
pub fn classic(placed: &Placed, monitor: &Monitor) -> Option<Classic> {
    let all = 0..placed.world.elements.len();
    monitor.begin("classic matrix", all.len());
    let timed = block(&placed.world, all.clone(), std::slice::from_ref(&all), all.clone(), monitor)?;
    let start = Instant::now();
    let optics = whole_optics(placed);
    let solver = default_solver(all.len());
    let factors = factorise(&timed.block, &optics.reflectance, solver);
    let system = LocalSystem::new(&timed.block, &optics.reflectance, solver, factors.as_ref());
    let radiosity = system.solve(&optics.emission, &optics.emission);
    Some(Classic {
        radiosity,
        form_factor_time: timed.time,
        solve_time: start.elapsed(),
        matrix: timed.block,
    })
}

/// Optics of all elements, instance after instance.
pub fn whole_optics(placed: &Placed) -> Optics {
    let each: Vec<Optics> = (0..placed.instances.len()).map(|k| placed.optics_of(k)).collect();
    Optics {
        reflectance: each.iter().flat_map(|o| o.reflectance.iter().copied()).collect(),
        emission: each.iter().flat_map(|o| o.emission.iter().copied()).collect(),
    }
}

/// The largest difference between two radiosities, element by element, relative to the larger of the two; where both
/// are below rounding of the brightest, nothing is compared.
pub fn largest_difference(a: &[Rgb], b: &[Rgb]) -> f64 {
    let brightest = b.iter().flatten().fold(0.0f64, |most, v| most.max(v.abs()));
    let pairs = a.iter().flatten().zip(b.iter().flatten());
    pairs
        .map(|(&a, &b)| {
            let size = a.abs().max(b.abs());
            if size <= brightest * 1e-15 { 0.0 } else { (a - b).abs() / size }
        })
        .fold(0.0, f64::max)
}
