//! Down the receivers' hierarchy: what one group of receivers finds out about senders and what stands in between holds for
//! all that it consists of.

use super::Request;
use super::candidates::{Candidates, Entry, Verdict};
use super::receivers::{Group, receiver_groups};
use super::search::Search;
use super::viewers::Viewers;
use crate::monitor::Monitor;
use crate::world::Node;
use equilux_formats::RowGroup;
use std::ops::Range;
use std::time::{Duration, Instant};

/// Computes the rows of one block.
pub struct Descent<'a> {
    /// What is asked for.
    pub request: &'a Request<'a>,
    /// Progress, and the wish to stop.
    pub monitor: &'a Monitor,
}

/// Rows of consecutive receivers.
#[derive(Default)]
pub struct Found {
    /// The rows, one group a flat cluster.
    pub groups: Vec<RowGroup>,
    /// Their sums.
    pub sums: Vec<f64>,
    /// Number of form factors that were computed for each receiver.
    pub computed: Vec<u32>,
    /// Number of groups that are not what they were before; all, if there is no before.
    pub changed: usize,
    /// Time summed over threads.
    pub time: Duration,
}

/// Senders that a group of receivers may see, and what may stand in between.
pub struct Frontier<'a> {
    candidates: Candidates<'a>,
    senders: Vec<(u32, Range<usize>)>,
}

/// A frontier is worked out again when the receivers have become this much smaller.
const SMALLER: f64 = 0.7;

/// Senders stay closed on a frontier up to this share of the receivers' size, or of the distance to them.
const CLOSED: f64 = 0.5;

impl<'a> Descent<'a> {
    /// All rows.
    pub fn rows(&self) -> Found {
        let Some(group) = receiver_groups(self.request.world, self.request.receivers) else {
            return Found::default();
        };
        self.descend(&group, &Frontier::all(self.request), f64::INFINITY)
    }

    /// The rows of a group. `size` is that of the receivers that the frontier was made for.
    fn descend(&self, group: &Group, frontier: &Frontier<'a>, size: f64) -> Found {
        let start = Instant::now();
        let Some(halves) = &group.halves else { return self.search(group, frontier, start) };
        if self.monitor.stopped() {
            return Found::default();
        }
        let Request { world, receivers, .. } = *self.request;
        let viewers = Viewers::new(world, &receivers.elements(world)[group.elements.clone()]);
        let narrowed =
            (viewers.diameter <= SMALLER * size).then(|| frontier.narrowed(self.request, &viewers));
        let (frontier, size) = match &narrowed {
            Some(narrowed) => (narrowed, viewers.diameter),
            None => (frontier, size),
        };
        let time = start.elapsed();
        let [left, right] = &**halves;
        let (left, right) =
            rayon::join(|| self.descend(left, frontier, size), || self.descend(right, frontier, size));
        Found {
            groups: [left.groups, right.groups].into_iter().flatten().collect(),
            sums: [left.sums, right.sums].concat(),
            computed: [left.computed, right.computed].concat(),
            changed: left.changed + right.changed,
            time: time + left.time + right.time,
        }
    }

    fn search(&self, group: &Group, frontier: &Frontier<'a>, start: Instant) -> Found {
        if self.monitor.stopped() {
            return Found::default();
        }
        let rows = Search::rows(self.request, group.elements.clone(), frontier);
        self.monitor.advance(group.elements.len());
        Found {
            groups: vec![rows.group],
            sums: rows.sums,
            computed: vec![(rows.computed / group.elements.len()) as u32; group.elements.len()],
            changed: usize::from(rows.is_changed),
            time: start.elapsed(),
        }
    }
}

impl<'a> Frontier<'a> {
    /// Everything that sends, behind everything there is.
    fn all(request: &Request<'a>) -> Self {
        let (candidates, all) = Candidates::all(request.world);
        let roots = request.senders.iter().filter_map(|&sender| request.world.root_of(sender));
        Self { candidates, senders: roots.map(|root| (root as u32, all.clone())).collect() }
    }

    /// Whether there is nothing to be searched.
    pub fn is_empty(&self) -> bool {
        self.senders.is_empty()
    }

    /// The senders and their lists.
    pub fn senders(&self) -> impl Iterator<Item = (u32, &[Entry])> {
        self.senders.iter().map(|(node, list)| (*node, self.candidates.slice(list.clone())))
    }

    /// What some of the receivers see of it.
    fn narrowed(&self, request: &Request<'a>, viewers: &Viewers) -> Self {
        let mut candidates = Candidates::none(request.world);
        let mut narrowed = Self { candidates: Candidates::none(request.world), senders: vec![] };
        let mut open: Vec<(u32, Range<usize>)> = Vec::new();
        for (node, list) in self.senders() {
            open.push((node, candidates.adopt(list)));
            while let Some((node, list)) = open.pop() {
                let sender = &request.world.nodes[node as usize];
                if viewers.cannot_see(sender, request.world) || is_untouched(request, viewers, node) {
                    continue;
                }
                let Verdict::Between(kept) = candidates.narrow(list, viewers, sender) else { continue };
                match sender.children {
                    Some(children) if !stays_closed(sender, viewers) => {
                        open.extend(children.into_iter().rev().map(|child| (child, kept.clone())));
                    }
                    _ => {
                        let list = narrowed.candidates.adopt(candidates.slice(kept));
                        narrowed.senders.push((node, list));
                    }
                }
            }
        }
        narrowed
    }
}

/// Whether nothing that changed can matter to a sender around which nothing can have had an entry: only flat ones have. What
/// lies inside a flat sender is looked at entry by entry, later.
fn is_untouched(request: &Request, viewers: &Viewers, node: u32) -> bool {
    let (world, Some(revision)) = (request.world, &request.revision) else { return false };
    let sender = &world.nodes[node as usize];
    let is_outermost =
        |node| world.parent_of(node).is_none_or(|p| world.nodes[p as usize].polygon.is_empty());
    (sender.polygon.is_empty() || is_outermost(node))
        && !revision.change.anew[world.instance_of_node(node as usize)]
        && !revision.change.touches(world, viewers, sender)
}

fn stays_closed(sender: &Node, viewers: &Viewers) -> bool {
    let size = (sender.high - sender.low).length();
    size <= CLOSED * viewers.diameter.max(viewers.distance_to(sender))
}
