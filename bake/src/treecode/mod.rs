//! Rows of exact form factors to adaptively chosen senders: a point-to-cluster treecode.
//!
//! Receivers and senders form hierarchies. The traversal of the receivers' hierarchy keeps a frontier of senders that
//! may be visible, each with a list of possible occluders; lists only get shorter on the way down. A flat cluster of
//! receivers searches the senders from the frontier on, nearest first. A sender whose light cannot reach the receivers
//! is dropped; a small or distant sender gets one entry, its exact, occluded form factor; any other is opened. A search
//! ends early when every row sum has reached one. Compare Appel 1985 for the tree, Haines & Wallace 1994 for the
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
pub use resolution::{EXACT, MISSED, Resolution, rays_for_tolerance};

/// A block with statistics of its computation.
#[derive(Debug)]
pub struct Timed {
    /// The form factors, `receivers × nodes`.
    pub block: Rows,
    /// Σ_j F_ij of every receiver, before entries are rounded for storage.
    pub row_sums: Vec<f64>,
    /// Number of form factors that were computed: all, unless an older block was updated.
    pub computed: usize,
    /// Number of form factors computed for each receiver.
    pub computed_by_row: Vec<u32>,
    /// Whether the block equals the older one, except for the numbers of its columns.
    pub is_unchanged: bool,
    /// Time summed over threads.
    pub time: Duration,
}

/// The exact form factors of some receivers to every element of a world. Fails if the monitor was stopped.
pub fn exact_rows(world: &World, receivers: Audience, monitor: &Monitor) -> Result<Timed> {
    let everyone: Vec<usize> = (0..world.instances()).collect();
    let request = Request::new(world, receivers, &everyone, EXACT);
    block(&request, monitor)
}

/// Computes a block on all threads. Fails if the monitor was stopped.
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
