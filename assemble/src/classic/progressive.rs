//! Progressive refinement: the elements with the most unshot power shoot it at all others, row by row of a matrix
//! that is never stored. Cohen, Chen, Wallace & Greenberg 1988.
//!
//! F_ij = F_ji A_j / A_i: the state that i receives from shooter j follows from the row of j by reciprocity, as in
//! the paper. Reciprocity is exact for averages over elements and approximate for centroids, so the state differs
//! slightly from that of the matrix.

use super::ClassicSolution;
use equilux_bake::monitor::Monitor;
use equilux_bake::treecode::{Audience, exact_rows};
use equilux_bake::world::World;
use equilux_formats::{Element, Optics, Result, Rgb};
use std::time::Duration;

/// Number of elements that shoot together, for parallelism.
const BATCH_SHOOTERS: usize = 16;

/// Maximum average number of shots of an element, for scenes without equilibrium.
const MAX_SHOTS: usize = 100;

/// Shoot until the unshot power is below the share `unshot` of the emitted power. Fails if the monitor was stopped.
pub fn solve(world: &World, optics: &Optics, unshot: f64, monitor: &Monitor) -> Result<ClassicSolution> {
    let elements = &world.elements;
    let power = |left: &[Rgb]| -> f64 {
        left.iter().zip(elements).map(|(b, e)| e.area * b.iter().sum::<f64>()).sum()
    };
    let emitted = power(&optics.emission);
    let mut state = ShootingState {
        world,
        optics,
        radiosity: optics.emission.clone(),
        irradiance: vec![Rgb::BLACK; elements.len()],
        unshot: optics.emission.clone(),
        time: Duration::ZERO,
    };
    monitor.begin("shots", 0, 0.0);
    let mut shots = 0;
    while power(&state.unshot) > unshot * emitted && shots < MAX_SHOTS * elements.len() {
        let brightest = brightest(elements, &state.unshot);
        state.shoot(&brightest, monitor)?;
        shots += brightest.len();
        monitor.advance(brightest.len());
    }
    let ShootingState { radiosity, irradiance, time, .. } = state;
    Ok(ClassicSolution { radiosity, irradiance, form_factor_time: time, matrix_bytes: 0, shots: Some(shots) })
}

/// State of progressive refinement; vectors in W/m².
#[derive(Debug)]
struct ShootingState<'a> {
    world: &'a World,
    optics: &'a Optics,
    radiosity: Vec<Rgb>,
    irradiance: Vec<Rgb>,
    unshot: Vec<Rgb>,
    time: Duration,
}

impl ShootingState<'_> {
    /// Send all unshot radiosity of these elements.
    fn shoot(&mut self, shooters: &[usize], monitor: &Monitor) -> Result<()> {
        let world = self.world;
        let points: Vec<Element> = shooters.iter().map(|&j| world.elements[j]).collect();
        let timed = exact_rows(world, Audience::Points(&points), monitor)?;
        self.time += timed.time;
        let sent: Vec<Rgb> = shooters.iter().map(|&j| std::mem::take(&mut self.unshot[j])).collect();
        for (k, (shooter, sent)) in points.iter().zip(sent).enumerate() {
            for (node, seen) in timed.block.row(k) {
                let i = world.element_of(node).expect("an exact row names elements");
                let form_factor = seen * shooter.area / world.elements[i].area;
                let arrived = sent * form_factor;
                let reflected = self.optics.reflectance[i] * arrived;
                self.irradiance[i] += arrived;
                self.radiosity[i] += reflected;
                self.unshot[i] += reflected;
            }
        }
        Ok(())
    }
}

/// The elements with the most unshot power, in the order of elements, since neighbours share most of their search.
fn brightest(elements: &[Element], unshot: &[Rgb]) -> Vec<usize> {
    let power = |j: usize| elements[j].area * unshot[j].iter().sum::<f64>();
    let mut order: Vec<usize> = (0..elements.len()).filter(|&j| power(j) > 0.0).collect();
    let count = BATCH_SHOOTERS.min(order.len());
    if count < order.len() {
        order.select_nth_unstable_by(count, |&a, &b| power(b).total_cmp(&power(a)).then(a.cmp(&b)));
    }
    order.truncate(count);
    order.sort_unstable();
    order
}
