//! Rows of exact form factors to adaptively chosen senders: a point-to-cluster treecode.
//!
//! For each flat cluster of receivers the senders' hierarchy is searched from the top, nearest first. A sender that no
//! light can reach the receivers from is dropped; one that is small and far enough gets one entry, its exact, occluded
//! form factor; any other is opened. Faces between receivers and sender are carried along as a list that only gets
//! shorter on the way down. A search ends early when every row has reached one. Compare Appel 1985 for the tree,
//! Haines & Wallace 1994 for the shafts; what is new is that no entry is an approximation.

mod candidates;
mod receivers;
mod terminal;

use crate::monitor::Monitor;
use crate::world::{Node, World};
use candidates::{Candidates, Verdict};
use equilux_formats::{Precision, RowGroup, Rows};
use rayon::prelude::*;
use receivers::{Receivers, receiver_clusters};
use std::collections::BinaryHeap;
use std::ops::Range;
use std::time::{Duration, Instant};
use terminal::Evaluator;

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
            Self { opening: OPENING * tolerance, precision: Precision::Steps }
        }
    }
}

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
    /// Time summed over threads.
    pub time: Duration,
}

/// What is asked for: one block.
pub struct Request<'a> {
    /// The geometry.
    pub world: &'a World,
    /// The instance whose elements receive.
    pub receivers: usize,
    /// The instances that send.
    pub senders: &'a [usize],
    /// The range of nodes that columns count through.
    pub columns: Range<usize>,
    /// What each receiver is known to see already (of other senders), if anything.
    pub already: Option<&'a [f64]>,
    /// How exactly.
    pub resolution: Resolution,
}

/// Compute a block on all threads. None if the monitor was stopped.
pub fn block(request: &Request, monitor: &Monitor) -> Option<Timed> {
    let clusters = receiver_clusters(request.world, request.receivers);
    let results: Vec<(RowGroup, Vec<f64>, Duration)> = clusters
        .into_par_iter()
        .map(|elements| {
            let start = Instant::now();
            let count = elements.len();
            let (group, sums) = if monitor.stopped() {
                (RowGroup { receivers: count, ..RowGroup::default() }, vec![0.0; count])
            } else {
                Search::new(request, elements).run()
            };
            monitor.advance(count);
            (group, sums, start.elapsed())
        })
        .collect();
    if monitor.stopped() {
        return None;
    }
    let time = results.iter().map(|(_, _, time)| *time).sum();
    let row_sums = results.iter().flat_map(|(_, sums, _)| sums.iter().copied()).collect();
    let groups = results.into_iter().map(|(group, _, _)| group);
    let block = Rows::from_groups(request.columns.len(), groups, request.resolution.precision);
    Some(Timed { block, row_sums, time })
}

/// Rows that have come this close to one are complete; what is still missing is shared by all senders not yet met.
const COMPLETE: f64 = 1e-12;

/// The same where entries stand for clusters anyway.
const NEARLY_COMPLETE: f64 = 1e-6;

/// How much wider clusters open that nothing stands before, found by measuring: it gives all links the same share of the
/// error in furnished rooms.
const CLEAR: f64 = 5.0;

/// One cluster of receivers looking for its senders.
struct Search<'a> {
    request: &'a Request<'a>,
    receivers: Receivers,
    candidates: Candidates<'a>,
    evaluator: Evaluator<'a>,
    queue: BinaryHeap<Open>,
    /// Columns and values found, values by sender.
    columns: Vec<u32>,
    values: Vec<f64>,
    missing: Vec<f64>,
}

/// A sender that has not been looked at, nearest first.
struct Open {
    distance: f64,
    node: u32,
    candidates: Range<usize>,
}

impl<'a> Search<'a> {
    fn new(request: &'a Request<'a>, elements: Range<usize>) -> Self {
        let receivers = Receivers::new(request.world, elements.clone());
        let own = request.world.elements_of(request.receivers).start;
        let missing = match request.already {
            Some(seen) => elements.clone().map(|i| 1.0 - seen[i - own]).collect(),
            None => vec![1.0; elements.len()],
        };
        Self {
            request,
            candidates: Candidates::new(request.world),
            evaluator: Evaluator::new(request.world, elements.len()),
            receivers,
            queue: BinaryHeap::new(),
            columns: vec![],
            values: vec![],
            missing,
        }
    }

    fn run(mut self) -> (RowGroup, Vec<f64>) {
        let all = self.candidates.all();
        for &sender in self.request.senders {
            if let Some(root) = self.request.world.root_of(sender) {
                self.open(root as u32, all.clone());
            }
        }
        let enough = if self.request.resolution.opening == 0.0 { COMPLETE } else { NEARLY_COMPLETE };
        while let Some(next) = self.queue.pop() {
            if self.missing.iter().all(|&missing| missing <= enough) {
                break;
            }
            self.visit(next);
        }
        self.finish()
    }

    fn open(&mut self, node: u32, candidates: Range<usize>) {
        let distance = self.receivers.distance_to(&self.request.world.nodes[node as usize]);
        self.queue.push(Open { distance, node, candidates });
    }

    fn visit(&mut self, Open { node, candidates, .. }: Open) {
        let sender = &self.request.world.nodes[node as usize];
        if self.receivers.cannot_see(sender, self.request.world) {
            return;
        }
        let kept = match self.candidates.narrow(candidates, &self.receivers, sender) {
            Verdict::Hidden => return,
            Verdict::Between(kept) => kept,
        };
        match sender.children {
            Some(children) if !self.is_small(sender, kept.is_empty()) => {
                children.into_iter().for_each(|child| self.open(child, kept.clone()));
            }
            _ => self.take(node, kept),
        }
    }

    /// Whether a cluster may have one entry: it is a polygon, and its form factor times its size over its distance is
    /// small. What an entry errs by is this product times how much the radiosity varies within the cluster. That is
    /// more where something stands between, because what is hidden often has other light than what is not.
    fn is_small(&self, sender: &Node, clear: bool) -> bool {
        if sender.polygon.is_empty() || self.request.resolution.opening == 0.0 {
            return false;
        }
        let radius = (sender.high - sender.low).length() / 2.0;
        let distance = self.receivers.distance_to(sender) + radius;
        if distance <= 2.0 * radius {
            return false;
        }
        let form_factor = sender.area / (std::f64::consts::PI * distance * distance);
        let opening = self.request.resolution.opening * if clear { CLEAR } else { 1.0 };
        form_factor * radius / distance <= opening
    }

    /// One entry for the sender: its form factor for every receiver.
    fn take(&mut self, node: u32, candidates: Range<usize>) {
        let sender = &self.request.world.nodes[node as usize];
        let list = self.candidates.occluders(candidates, &self.receivers, sender);
        let Verdict::Between(list) = list else { return };
        let first = self.values.len();
        let occluders = self.candidates.slice(list);
        if !self.evaluator.evaluate(&self.receivers, sender, occluders, &mut self.values) {
            self.values.truncate(first);
            return;
        }
        for (missing, value) in self.missing.iter_mut().zip(&self.values[first..]) {
            *missing -= value;
        }
        self.columns.push(node - self.request.columns.start as u32);
    }

    /// Columns in rising order, values by receiver.
    fn finish(self) -> (RowGroup, Vec<f64>) {
        let receivers = self.receivers.count();
        let mut order: Vec<usize> = (0..self.columns.len()).collect();
        order.sort_unstable_by_key(|&k| self.columns[k]);
        let columns = order.iter().map(|&k| self.columns[k]).collect();
        let row = |i: usize| order.iter().map(move |&k| (k, i));
        let values: Vec<f64> =
            (0..receivers).flat_map(row).map(|(k, i)| self.values[k * receivers + i]).collect();
        let width = order.len();
        let sums = (0..receivers).map(|i| values[i * width..(i + 1) * width].iter().sum()).collect();
        (RowGroup { columns, values, receivers }, sums)
    }
}

impl Ord for Open {
    fn cmp(&self, other: &Self) -> std::cmp::Ordering {
        other.distance.total_cmp(&self.distance).then(other.node.cmp(&self.node))
    }
}

impl PartialOrd for Open {
    fn partial_cmp(&self, other: &Self) -> Option<std::cmp::Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for Open {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other).is_eq()
    }
}

impl Eq for Open {}
