//! Rows of exact form factors to adaptively chosen senders: a point-to-cluster treecode.
//!
//! Receivers and senders are hierarchies. Down the receivers' goes a frontier of senders that may be seen from there, each
//! with a list of what may stand in between; lists only get shorter on the way down. At a flat cluster of receivers the
//! senders are searched from the frontier on, nearest first. A sender that no light can reach the receivers from is
//! dropped; one that is small and far enough gets one entry, its exact, occluded form factor; any other is opened. A
//! search ends early when every row has reached one. Compare Appel 1985 for the tree, Haines & Wallace 1994 for the
//! shafts; what is new is that no entry is an approximation.

mod candidates;
mod descent;
mod evaluate;
mod frontier;
mod pieces;
mod pyramids;
mod receivers;
mod request;
mod resolution;
pub mod revision;
mod search;
mod seen_meshes;
mod viewers;

use crate::monitor::Monitor;
use crate::world::World;
use descent::Descent;
use equilux_formats::{Error, Result, Rows};
use std::time::Duration;

pub use request::{Audience, Request};
pub use resolution::{EXACT, MISSED, Resolution};

/// A block and what it took.
#[derive(Debug)]
pub struct Timed {
    /// The form factors, `receivers × nodes`.
    pub block: Rows,
    /// Σ_j F_ij of every receiver as computed, before the numbers are rounded for keeping.
    pub row_sums: Vec<f64>,
    /// Number of form factors that were computed: all, unless an older block was brought up to date.
    pub computed: usize,
    /// The same, receiver by receiver.
    pub computed_by_row: Vec<u32>,
    /// Whether an older block stays as it was, but for the numbers of its columns.
    pub is_unchanged: bool,
    /// Time summed over threads.
    pub time: Duration,
}

/// Every form factor of some receivers to all elements of a world, in full. Fails if the monitor was stopped.
pub fn exact_rows(world: &World, receivers: Audience, monitor: &Monitor) -> Result<Timed> {
    let everyone: Vec<usize> = (0..world.instances()).collect();
    let request = Request::new(world, receivers, &everyone, EXACT);
    block(&request, monitor)
}

/// Compute a block on all threads. Fails if the monitor was stopped.
pub fn block(request: &Request, monitor: &Monitor) -> Result<Timed> {
    let found = Descent { request, monitor }.rows();
    if monitor.stopped() {
        return Err(Error::Stopped);
    }
    let older = request.revision.as_ref().filter(|older| older.is_in_place(&request.columns));
    let unchanged = older.filter(|_| found.changed == 0).map(|older| older.old.clone());
    let is_unchanged = unchanged.is_some();
    let made = || Rows::from_groups(request.columns.len(), found.groups, request.resolution.precision);
    Ok(Timed {
        block: unchanged.unwrap_or_else(made),
        row_sums: found.sums,
        computed: found.computed.iter().map(|&count| count as usize).sum(),
        computed_by_row: found.computed,
        is_unchanged,
        time: found.time,
    })
}
