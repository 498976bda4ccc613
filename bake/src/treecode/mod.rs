//! Rows of exact form factors to adaptively chosen senders: a point-to-cluster treecode.
//!
//! Receivers and senders are hierarchies. Down the receivers' goes a frontier of senders that may be seen from there, each
//! with a list of what may stand in between; lists only get shorter on the way down. At a flat cluster of receivers the
//! senders are searched from the frontier on, nearest first. A sender that no light can reach the receivers from is
//! dropped; one that is small and far enough gets one entry, its exact, occluded form factor; any other is opened. A
//! search ends early when every row has reached one. Compare Appel 1985 for the tree, Haines & Wallace 1994 for the
//! shafts; what is new is that no entry is an approximation.

mod candidates;
mod cones;
mod descent;
mod pieces;
mod receivers;
pub mod revision;
mod search;
mod seen_meshes;
mod terminal;
mod viewers;

use crate::monitor::Monitor;
use crate::world::World;
use descent::Descent;
use equilux_formats::{Element, Precision, Rows};
use revision::Revision;
use std::ops::Range;
use std::time::Duration;
pub(crate) use viewers::box_corners;

/// How a block is computed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Resolution {
    /// A cluster is taken as a whole if its form factor (at most) × its radius over its distance is below this. 0 takes
    /// elements only: the exact matrix.
    pub opening: f64,
    /// How the numbers are kept.
    pub precision: Precision,
}

/// Every element on its own, every number in full.
pub const EXACT: Resolution = Resolution { opening: 0.0, precision: Precision::Full };

impl Resolution {
    /// The resolution at which radiosity errs by about `tolerance`, relative to its mean, in furnished rooms; the proof
    /// is the bound of the exchange, not this. 0 is exact.
    pub fn for_tolerance(tolerance: f64) -> Self {
        if tolerance == 0.0 {
            EXACT
        } else {
            Self { opening: OPENING * tolerance, precision: Precision::Single }
        }
    }
}

/// What a row whose entries stand for clusters may miss of all it sees, at most: a search ends when a tenth of this is missing,
/// and the rest is for rounding.
pub const MISSED: f64 = 1e-5;

/// Opening per tolerance, found by measuring.
const OPENING: f64 = 0.1;

impl std::fmt::Display for Resolution {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        if *self == EXACT {
            write!(f, "exact")
        } else {
            write!(f, "clusters up to {:e}, {:?}", self.opening, self.precision)
        }
    }
}

/// A block and what it took.
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

/// Who receives.
#[derive(Debug, Clone, Copy)]
pub enum Audience<'a> {
    /// The elements of an instance of the world.
    Instance(usize),
    /// Other points, at the centroids of these elements, each of which lies in a face of the world. The nearer two are in
    /// this order the more of their search they share.
    Points(&'a [Element]),
}

impl<'a> Audience<'a> {
    /// The receivers' elements.
    pub(crate) fn elements(self, world: &'a World) -> &'a [Element] {
        match self {
            Self::Instance(instance) => &world.elements[world.elements_of(instance)],
            Self::Points(elements) => elements,
        }
    }
}

/// What is asked for: one block.
pub struct Request<'a> {
    /// The geometry.
    pub world: &'a World,
    /// Who receives.
    pub receivers: Audience<'a>,
    /// The instances that send.
    pub senders: &'a [usize],
    /// The range of nodes that columns count through.
    pub columns: Range<usize>,
    /// What each receiver is known to see already (of other senders), if anything.
    pub already: Option<&'a [f64]>,
    /// How exactly.
    pub resolution: Resolution,
    /// The block as it was before the scene changed, if it is only to be brought up to date.
    pub revision: Option<Revision<'a>>,
}

/// Every form factor of some receivers to all elements of a world, in full. None if the monitor was stopped.
pub fn exact_rows(world: &World, receivers: Audience, monitor: &Monitor) -> Option<Timed> {
    let everyone: Vec<usize> = (0..world.instances()).collect();
    let request = Request {
        world,
        receivers,
        senders: &everyone,
        columns: 0..world.nodes.len(),
        already: None,
        resolution: EXACT,
        revision: None,
    };
    block(&request, monitor)
}

/// Compute a block on all threads. None if the monitor was stopped.
pub fn block(request: &Request, monitor: &Monitor) -> Option<Timed> {
    let found = Descent { request, monitor }.rows();
    if monitor.stopped() {
        return None;
    }
    let older = request.revision.as_ref().filter(|older| older.is_in_place(&request.columns));
    let unchanged = older.filter(|_| found.changed == 0).map(|older| older.old.clone());
    let is_unchanged = unchanged.is_some();
    let made = || Rows::from_groups(request.columns.len(), found.groups, request.resolution.precision);
    Some(Timed {
        block: unchanged.unwrap_or_else(made),
        row_sums: found.sums,
        computed: found.computed.iter().map(|&count| count as usize).sum(),
        computed_by_row: found.computed,
        is_unchanged,
        time: found.time,
    })
}
