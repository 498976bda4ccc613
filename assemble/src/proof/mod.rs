//! What is known about the error of an answer whose form factors stand for clusters: radiosity varies within a cluster,
//! and nothing in the exchange notices. In go the form factors as they are kept and the answer; out comes a proved bound
//! for every element, and what exact rows of some receivers say.

pub mod enclosure;
pub mod endless;
pub mod exact_rows;
pub mod sample;

use crate::exchange::outcome::Outcome;
use crate::exchange::system::InstanceSystem;
use crate::exchange::system::residual;
use crate::placed_parts::PlacedParts;
use crate::statistics::mean_over_area;
use enclosure::{StoredFormFactors, is_compressed};
use equilux_bake::monitor::Monitor;
use equilux_formats::Rgb;
use exact_rows::{Residuals, residuals};
use sample::{ExactRows, ReceiverCluster, choose};
use std::time::Duration;

/// What is proved and what was measured. The exact answer is that of the matrix in which every entry is for one element.
#[derive(Debug)]
pub struct Proof {
    /// No radiosity is further than this from the exact answer, W/m², one row an element.
    pub bound: Vec<Rgb>,
    /// What the spread of radiosity within clusters alone proves, W/m², one row an element.
    pub spread: Vec<Rgb>,
    /// What exact rows say, if there are any.
    pub measured: Option<ResidualStatistics>,
}

/// The residual of the answer where rows are exact.
#[derive(Debug)]
pub struct ResidualStatistics {
    /// Number of rows; if they are all, they are what the bound is proved from.
    pub rows: usize,
    /// Largest residual, W/m².
    pub largest: f64,
    /// Largest residual over the mean radiosity, the worst channel.
    pub largest_over_mean: f64,
    /// Root mean square of the residual over the mean radiosity, the worst channel, from the area that each row speaks for.
    pub rms_over_mean: f64,
    /// That over 1 − ρ̄: what the residual becomes if all of it is reflected on and has one sign. An estimate of the error
    /// of the whole answer, mostly too large; not a bound, unless rows are all there are.
    pub estimate: f64,
    /// Form factors computed for it.
    pub form_factors: usize,
    /// Time spent on them, summed over threads.
    pub time: Duration,
}

/// Prove and measure what there is to know about the answer; none if every entry is for one element and kept in full, for
/// then the exchange's own bound says it all.
pub fn prove(
    placed: &PlacedParts,
    systems: &[InstanceSystem],
    outcome: &Outcome,
    wanted: ExactRows,
    monitor: &Monitor,
) -> Option<Proof> {
    if !is_compressed(systems) {
        return None;
    }
    let (radiosity, irradiance) = (placed.split(&outcome.radiosity), placed.split(&outcome.irradiance));
    let kept = StoredFormFactors::of(systems);
    let solved = residual(systems, &radiosity, &irradiance);
    let spread = kept.enclose(&sums_of_sizes(&solved, &kept.spread(&radiosity))).concat();

    let chosen = choose(placed, systems, wanted);
    // Without exact rows, because none are wanted or the run was stopped, the spread is all that proves anything.
    let found =
        if chosen.is_empty() { None } else { residuals(placed, systems, &radiosity, &chosen, monitor).ok() };
    let Some(found) = found else { return Some(Proof { bound: spread.clone(), spread, measured: None }) };
    let measured = measured(placed, systems, outcome, &chosen, &found);
    let bound = if measured.rows == placed.world.elements.len() {
        let exact = kept.enclose(&placed.split(&sizes(&found.values.concat()))).concat();
        spread.iter().zip(exact).map(|(&a, b)| Rgb::from_fn(|c| a[c].min(b[c]))).collect()
    } else {
        spread.clone()
    };
    Some(Proof { bound, spread, measured: Some(measured) })
}

fn measured(
    placed: &PlacedParts,
    systems: &[InstanceSystem],
    outcome: &Outcome,
    chosen: &[ReceiverCluster],
    found: &Residuals,
) -> ResidualStatistics {
    let reflectance: Vec<Rgb> = systems.iter().flat_map(|system| system.optics.reflectance.clone()).collect();
    let [mean, rho] =
        [&outcome.radiosity, &reflectance].map(|values| mean_over_area(&placed.world.elements, values));
    let rms = rms(placed, chosen, &found.values);
    let largest = equilux_bake::equilibrium::largest(&found.values.concat());
    let worst = |of: &dyn Fn(usize) -> f64| (0..3).map(of).fold(0.0, f64::max);
    let over = |value: f64, unit: f64| if value == 0.0 { 0.0 } else { value / unit };
    ResidualStatistics {
        rows: chosen.iter().map(|cluster| cluster.receivers.len()).sum(),
        largest: worst(&|c| largest[c]),
        largest_over_mean: worst(&|c| over(largest[c], mean[c])),
        rms_over_mean: worst(&|c| over(rms[c], mean[c])),
        estimate: worst(&|c| over(rms[c], mean[c] * (1.0 - rho[c]))),
        form_factors: found.form_factors,
        time: found.time,
    }
}

/// Root mean square over the scene's area: each cluster's own mean square over its area, for the area it speaks for.
fn rms(placed: &PlacedParts, chosen: &[ReceiverCluster], values: &[Vec<Rgb>]) -> Rgb {
    let (mut squares, mut spoken) = (Rgb::BLACK, 0.0);
    for (cluster, values) in chosen.iter().zip(values) {
        let elements =
            &placed.world.elements[placed.world.elements_of(cluster.instance)][cluster.receivers.clone()];
        let own: f64 = elements.iter().map(|e| e.area).sum();
        for (element, value) in elements.iter().zip(values) {
            let weight = cluster.area * element.area / own;
            squares += *value * weight * *value;
        }
        spoken += cluster.area;
    }
    squares.map(|square: f64| (square / spoken).sqrt())
}

fn sizes(values: &[Rgb]) -> Vec<Rgb> {
    values.iter().map(|v| v.map(f64::abs)).collect()
}

/// |a| + |b|, one vector an instance.
fn sums_of_sizes(a: &[Vec<Rgb>], b: &[Vec<Rgb>]) -> Vec<Vec<Rgb>> {
    let sum =
        |(a, b): (&Vec<Rgb>, &Vec<Rgb>)| sizes(a).into_iter().zip(sizes(b)).map(|(a, b)| a + b).collect();
    a.iter().zip(b).map(sum).collect()
}
