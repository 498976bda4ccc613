//! What an answer that was found with clusters misses where rows are exact: r_i = E_i + ρ_i Σ_j F_ij B_j − B_i, every j an
//! element. A few rows tell how large r is, all of them bound the error.

use super::sample::ReceiverCluster;
use crate::exchange::system::InstanceSystem;
use crate::placed_parts::PlacedParts;
use equilux_bake::equilibrium::apply;
use equilux_bake::monitor::Monitor;
use equilux_bake::treecode::{Audience, EXACT, Request, block};
use equilux_formats::{Result, Rgb, Rows};
use std::time::Duration;

/// An exact row takes about as much time as this many rows with clusters.
pub const ROWS_PER_EXACT_ROW: f64 = 4.0;

/// At most about so many exact rows are in memory at a time.
const AT_ONCE: usize = 1024;

/// The residuals of some receivers.
#[derive(Debug)]
pub struct Residuals {
    /// W/m², one vector a cluster of receivers, in the order in which they were chosen.
    pub values: Vec<Vec<Rgb>>,
    /// Number of form factors computed.
    pub form_factors: usize,
    /// Time spent on them, summed over threads.
    pub time: Duration,
}

/// Compute exact rows for the chosen receivers and what `radiosity` (one vector an instance) misses there. Fails if
/// the monitor was stopped.
pub fn residuals(
    placed: &PlacedParts,
    systems: &[InstanceSystem],
    radiosity: &[Vec<Rgb>],
    chosen: &[ReceiverCluster],
    monitor: &Monitor,
) -> Result<Residuals> {
    let mut all = Vec::new();
    systems.iter().zip(radiosity).for_each(|(system, b)| system.clusters.append_means(b, &mut all));
    let count: usize = chosen.iter().map(|cluster| cluster.receivers.len()).sum();
    monitor.begin("exact rows", count, ROWS_PER_EXACT_ROW * count as f64);
    let mut residuals = Residuals { values: vec![], form_factors: 0, time: Duration::ZERO };
    for batch in batches(chosen) {
        let (rows, time) = exact_rows(placed, batch, monitor)?;
        residuals.form_factors += rows.stored();
        residuals.time += time;
        let system = &systems[batch[0].instance];
        let own = &radiosity[batch[0].instance];
        let irradiance = apply(&rows, &all);
        let missed = |i: usize| {
            let right = system.optics.emission[i] + system.optics.reflectance[i] * irradiance[i];
            right - own[i]
        };
        residuals.values.extend(batch.iter().map(|cluster| cluster.receivers.clone().map(missed).collect()));
    }
    Ok(residuals)
}

/// Runs of clusters of one instance, few enough rows to be kept at once.
fn batches(chosen: &[ReceiverCluster]) -> Vec<&[ReceiverCluster]> {
    let mut batches = Vec::new();
    for own in chosen.chunk_by(|a, b| a.instance == b.instance) {
        let mut rows = 0;
        let together = own.chunk_by(|a, _| {
            rows += a.receivers.len();
            let fits = rows < AT_ONCE;
            if !fits {
                rows = 0;
            }
            fits
        });
        batches.extend(together);
    }
    batches
}

/// The rows of clusters of one instance; all other rows of the instance are empty.
fn exact_rows(
    placed: &PlacedParts,
    clusters: &[ReceiverCluster],
    monitor: &Monitor,
) -> Result<(Rows, Duration)> {
    let world = &placed.world;
    let instance = clusters[0].instance;
    // For a receiver that sees everything already nothing is searched.
    let mut seen = vec![1.0; world.elements_of(instance).len()];
    clusters.iter().for_each(|cluster| seen[cluster.receivers.clone()].fill(0.0));
    let everyone: Vec<usize> = (0..placed.instances.len()).collect();
    let request =
        Request::new(world, Audience::Instance(instance), &everyone, EXACT).with_already(Some(&seen));
    let timed = block(&request, monitor)?;
    Ok((timed.block, timed.time))
}
