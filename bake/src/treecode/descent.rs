//! Traversal of the receivers' hierarchy: the senders and occluders found for a group of receivers hold for all of its
//! subgroups.

use super::frontier::Frontier;
use super::receivers::{Group, receiver_groups};
use super::request::Request;
use super::search::Search;
use super::viewers::Viewers;
use crate::monitor::Monitor;
use equilux_formats::rows::RowGroup;
use std::time::{Duration, Instant};

/// Computes the rows of one block.
pub struct Descent<'a> {
    /// The block to compute.
    pub request: &'a Request<'a>,
    /// Progress, and the request to stop.
    pub monitor: &'a Monitor,
}

/// Rows of consecutive receivers.
#[derive(Default)]
pub struct BlockRows {
    /// The rows, one group a flat cluster.
    pub groups: Vec<RowGroup>,
    /// Their sums.
    pub sums: Vec<f64>,
    /// Number of form factors that were computed for each receiver.
    pub computed: Vec<u32>,
    /// Number of groups that differ from those of the older block; all, if there is none.
    pub changed: usize,
    /// Time summed over threads.
    pub time: Duration,
}

/// A frontier is narrowed when the size of the receivers has shrunk to this share.
const NARROWING_RATIO: f64 = 0.7;

impl<'a> Descent<'a> {
    /// All rows.
    pub fn rows(&self) -> BlockRows {
        let Some(group) = receiver_groups(self.request.world, self.request.receivers) else {
            return BlockRows::default();
        };
        self.descend(&group, &Frontier::all(self.request), f64::INFINITY)
    }

    /// The rows of a group. `size` is the diameter of the receivers that the frontier was narrowed for.
    fn descend(&self, group: &Group, frontier: &Frontier<'a>, size: f64) -> BlockRows {
        let start = Instant::now();
        let Some(halves) = &group.halves else { return self.search(group, frontier, start) };
        if self.monitor.stopped() {
            return BlockRows::default();
        }
        let Request { world, receivers, .. } = *self.request;
        let viewers = Viewers::new(world, &receivers.elements(world)[group.elements.clone()]);
        let narrowed =
            (viewers.diameter <= NARROWING_RATIO * size).then(|| frontier.narrowed(self.request, &viewers));
        let (frontier, size) = match &narrowed {
            Some(narrowed) => (narrowed, viewers.diameter),
            None => (frontier, size),
        };
        let time = start.elapsed();
        let [left, right] = &**halves;
        let (left, right) =
            rayon::join(|| self.descend(left, frontier, size), || self.descend(right, frontier, size));
        BlockRows {
            groups: [left.groups, right.groups].into_iter().flatten().collect(),
            sums: [left.sums, right.sums].concat(),
            computed: [left.computed, right.computed].concat(),
            changed: left.changed + right.changed,
            time: time + left.time + right.time,
        }
    }

    fn search(&self, group: &Group, frontier: &Frontier<'a>, start: Instant) -> BlockRows {
        if self.monitor.stopped() {
            return BlockRows::default();
        }
        let rows = Search::rows(self.request, group.elements.clone(), frontier);
        self.monitor.advance(group.elements.len());
        BlockRows {
            groups: vec![rows.group],
            sums: rows.sums,
            computed: vec![(rows.computed / group.elements.len()) as u32; group.elements.len()],
            changed: usize::from(rows.is_changed),
            time: start.elapsed(),
        }
    }
}
