//! The error of a solution whose form factors represent clusters: radiosity varies within a cluster, which the
//! exchange cannot detect. Input: the stored form factors and the solution. Output: a proved bound for every element,
//! and residuals measured in exact rows. Rows by rays have no clusters: their noise is measured, and on request they are compared
//! with exact rows.

pub mod audit;
pub mod enclosure;
pub mod endless;
pub mod exact_rows;
pub mod noise;
pub mod sample;

use crate::exchange::outcome::Outcome;
use crate::exchange::system::{InstanceSystem, residual};
use crate::placed_parts::PlacedParts;
use crate::statistics::mean_over_area;
use enclosure::{StoredFormFactors, is_compressed};
use equilux_bake::monitor::Monitor;
use equilux_formats::Rgb;
use exact_rows::{Residuals, residuals};
use sample::{ExactRows, ReceiverCluster, choose};
use std::time::Duration;

/// Proved bounds and measured residuals. The exact solution is that of the matrix in which every entry is for one
/// element.
#[derive(Debug)]
pub struct Proof {
    /// Upper bound on the distance of each radiosity from the exact solution, W/m², one row an element.
    pub bound: Vec<Rgb>,
    /// The bound that follows from the spread of radiosity within clusters alone, W/m², one row an element.
    pub spread: Vec<Rgb>,
    /// Residuals in exact rows, if there are any.
    pub measured: Option<ResidualStatistics>,
}

/// Statistics of the residuals in exact rows.
#[derive(Debug)]
pub struct ResidualStatistics {
    /// Number of rows. If these are all rows, the bound is proved from them.
    pub rows: usize,
    /// Largest residual, W/m².
    pub largest: f64,
    /// Largest residual relative to the mean radiosity, the worst channel.
    pub largest_over_mean: f64,
    /// Root mean square residual relative to the mean radiosity, the worst channel, weighted by the area that each
    /// row represents.
    pub rms_over_mean: f64,
    /// The root mean square residual divided by 1 − ρ̄: the error if all of the residual has the same sign and is
    /// reflected repeatedly. An estimate of the error of the whole solution, usually too large; not a bound unless it
    /// covers all rows.
    pub estimate: f64,
    /// Number of form factors computed.
    pub form_factors: usize,
    /// Time spent on form factors, summed over threads.
    pub time: Duration,
}

/// Prove and measure the error of a solution. None if every entry is for one element and stored in full: then the
/// bound of the exchange is complete.
pub fn prove(
    placed: &PlacedParts,
    systems: &[InstanceSystem],
    outcome: &Outcome,
    requested: ExactRows,
    monitor: &Monitor,
) -> Option<Proof> {
    if !is_compressed(systems) {
        return None;
    }
    let (radiosity, irradiance) = (placed.split(&outcome.radiosity), placed.split(&outcome.irradiance));
    let kept = StoredFormFactors::of(systems);
    let exchange_residual = residual(systems, &radiosity, &irradiance);
    let spread = kept.enclose(&sums_of_sizes(&exchange_residual, &kept.spread(&radiosity))).concat();

    let chosen = choose(placed, systems, requested);
    // Without exact rows, because none are requested or the run was stopped, only the spread proves a bound.
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

/// Root mean square over the scene's area: the mean square of each cluster over its own area, weighted by the area
/// that it represents.
fn rms(placed: &PlacedParts, chosen: &[ReceiverCluster], values: &[Vec<Rgb>]) -> Rgb {
    let (mut squares, mut represented) = (Rgb::BLACK, 0.0);
    for (cluster, values) in chosen.iter().zip(values) {
        let elements =
            &placed.world.elements[placed.world.elements_of(cluster.instance)][cluster.receivers.clone()];
        let own: f64 = elements.iter().map(|e| e.area).sum();
        for (element, value) in elements.iter().zip(values) {
            let weight = cluster.area * element.area / own;
            squares += *value * weight * *value;
        }
        represented += cluster.area;
    }
    squares.map(|square: f64| (square / represented).sqrt())
}

fn sizes(values: &[Rgb]) -> Vec<Rgb> {
    values.iter().map(|v| v.map(f64::abs)).collect()
}

/// a| + |b|, one vector for each instance.
fn sums_of_sizes(a: &[Vec<Rgb>], b: &[Vec<Rgb>]) -> Vec<Vec<Rgb>> {
    let sum =
        |(a, b): (&Vec<Rgb>, &Vec<Rgb>)| sizes(a).into_iter().zip(sizes(b)).map(|(a, b)| a + b).collect();
    a.iter().zip(b).map(sum).collect()
}
