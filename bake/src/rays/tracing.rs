//! Many rows at once, on all threads.

use super::wide_tree::Ray;
use crate::monitor::Monitor;
use equilux_formats::{Error, Result};
use rayon::prelude::*;

/// Reused memory of a thread.
#[derive(Debug, Default)]
pub struct Scratch {
    /// Rays of a row.
    pub rays: Vec<Ray>,
    /// What they end on in the own part.
    pub own: Vec<u32>,
    /// And elsewhere.
    pub others: Vec<u32>,
}

/// The rows of all unknowns, in order, on all threads.
pub fn traced<T: Send>(
    unknowns: usize,
    monitor: &Monitor,
    row: impl Fn(usize, &mut Scratch) -> T + Sync,
) -> Result<Vec<T>> {
    let found: Vec<Option<T>> = (0..unknowns)
        .into_par_iter()
        .map_init(Scratch::default, |scratch, unknown| {
            if monitor.stopped() {
                return None;
            }
            monitor.advance(1);
            Some(row(unknown, scratch))
        })
        .collect();
    found.into_iter().collect::<Option<Vec<T>>>().ok_or(Error::Stopped)
}

/// How often each number occurs, numbers rising.
pub fn tallied(hits: &mut [u32]) -> Vec<(u32, u16)> {
    hits.sort_unstable();
    hits.chunk_by(|a, b| a == b).map(|same| (same[0], same.len() as u16)).collect()
}
