//! Residuals of a solution with clusters where rows are exact: r_i = E_i + ρ_i Σ_j F_ij B_j − B_i, where every j is
//! an element. A sample of rows estimates the size of r; all rows together bound the error.

use super::sample::ReceiverCluster;
use crate::exchange::system::InstanceSystem;
use crate::placed_parts::PlacedParts;
use equilux_bake::equilibrium::apply;
use equilux_bake::monitor::Monitor;
use equilux_bake::treecode::{Audience, EXACT, Request, block};
use equilux_formats::{Result, Rgb, Rows};
use std::time::Duration;

/// Cost of an exact row, in rows with clusters.
pub const ROWS_PER_EXACT_ROW: f64 = 4.0;

/// Approximate number of exact rows in memory at a time.
const BATCH_ROWS: usize = 1024;

/// Residuals of chosen receivers.
#[derive(Debug)]
pub struct Residuals {
    /// W/m², one vector for each receiver cluster, in the order of the clusters.
    pub values: Vec<Vec<Rgb>>,
    /// Number of form factors computed.
    pub form_factors: usize,
    /// Time spent on form factors, summed over threads.
    pub time: Duration,
}

/// Compute exact rows for the chosen receivers, and the residuals of `radiosity` (W/m², one vector for each instance)
/// in them. Fails if the monitor was stopped.
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

/// Batches of consecutive clusters of one instance, with few enough rows to be stored at the same time.
fn batches(chosen: &[ReceiverCluster]) -> Vec<&[ReceiverCluster]> {
    let mut batches = Vec::new();
    for own in chosen.chunk_by(|a, b| a.instance == b.instance) {
        let mut rows = 0;
        let together = own.chunk_by(|a, _| {
            rows += a.receivers.len();
            let fits = rows < BATCH_ROWS;
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
    // Rows that already sum to 1 are not searched.
    let mut seen = vec![1.0; world.elements_of(instance).len()];
    clusters.iter().for_each(|cluster| seen[cluster.receivers.clone()].fill(0.0));
    let everyone: Vec<usize> = (0..placed.instances.len()).collect();
    let request =
        Request::new(world, Audience::Instance(instance), &everyone, EXACT).with_already(Some(&seen));
    let timed = block(&request, monitor)?;
    Ok((timed.block, timed.time))
}
