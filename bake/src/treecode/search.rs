//! The search of one flat cluster of receivers for its senders.

use super::candidates::{Candidates, Verdict};
use super::evaluate::Evaluator;
use super::frontier::Frontier;
use super::receivers::Receivers;
use super::request::Request;
use super::resolution::MISSED;
use super::revision::Revised;
use crate::world::Sender;
use equilux_formats::rows::RowGroup;
use std::collections::BinaryHeap;
use std::ops::Range;

/// A row whose sum lacks less than this to one is complete; the rest bounds the form factors of all remaining senders.
const ROW_COMPLETE: f64 = 1e-12;

/// The same for blocks with entries for clusters.
const CLUSTERED_ROW_COMPLETE: f64 = MISSED / 10.0;

/// Factor on the opening for unoccluded clusters, measured: all entries then contribute equally to the error in
/// furnished rooms.
const UNOCCLUDED_OPENING_FACTOR: f64 = 5.0;

/// Levels of the senders' hierarchy between two narrowings of a list.
const NARROW_EVERY: u32 = 2;

/// Partly occluded clusters are tried up to this ratio of estimated to allowed error, because often little of them is visible.
const MAX_TRIAL_ERROR_RATIO: f64 = 16.0;

/// Share of the allowed error for such a cluster, because its visible part may differ from the rest.
const PARTIAL_VISIBILITY_SHARE: f64 = 0.3;

/// After a failed try, the estimated error must shrink to this share before the next one.
const RETRY_SHRINK: f64 = 0.25;

/// The search of one cluster of receivers.
pub struct Search<'a> {
    request: &'a Request<'a>,
    receivers: Receivers,
    candidates: Candidates<'a>,
    evaluator: Evaluator<'a>,
    queue: BinaryHeap<Open>,
    /// Columns and values found, values by sender.
    columns: Vec<u32>,
    values: Vec<f64>,
    missing: Vec<f64>,
    /// The older rows, if they are updated.
    revised: Option<Revised<'a>>,
}

/// Rows of one cluster of receivers.
pub struct GroupRows {
    /// The rows.
    pub group: RowGroup,
    /// Their sums.
    pub sums: Vec<f64>,
    /// Number of form factors that were computed.
    pub computed: usize,
    /// Whether they differ from the older rows.
    pub is_changed: bool,
}

/// A sender that has not been visited; ordered nearest first.
struct Open {
    distance: f64,
    node: u32,
    candidates: Range<usize>,
    /// Levels since the list was last narrowed.
    levels: u32,
    /// The estimated error of the last try of a cluster around it.
    tried: f64,
    /// Whether it must be visited even if the change cannot affect it, because it or a cluster around it has lost its entry.
    lost: bool,
}

/// The result of trying to give a sender one entry.
enum Attempt {
    /// It has its entry, or needs none.
    Done,
    /// Too much of it is visible for one entry.
    TooMuch,
}

impl<'a> Search<'a> {
    /// The rows of some elements on one side of one face, and their sums.
    pub fn rows(request: &'a Request<'a>, elements: Range<usize>, frontier: &Frontier<'a>) -> GroupRows {
        let missing: Vec<f64> = match request.already {
            Some(seen) => seen[elements.clone()].iter().map(|seen| 1.0 - seen).collect(),
            None => vec![1.0; elements.len()],
        };
        let receivers =
            Receivers::new(request.world, &request.receivers.elements(request.world)[elements.clone()]);
        let revised = request.revision.as_ref();
        if let Some(group) = revised
            .filter(|_| frontier.is_empty())
            .and_then(|r| r.untouched(request.columns.start, &elements))
        {
            let width = group.columns.len();
            let sum = |i: usize| group.values[i * width..(i + 1) * width].iter().sum();
            return GroupRows {
                sums: (0..group.receivers).map(sum).collect(),
                group,
                computed: 0,
                is_changed: false,
            };
        }
        let revised =
            revised.map(|revision| Revised::new(request.world, revision, &receivers.viewers, &elements));
        let missing = match &revised {
            Some(revised) => {
                missing.iter().zip(revised.seen()).map(|(m, seen): (&f64, f64)| m - seen).collect()
            }
            None => missing,
        };
        let search = Self {
            revised,
            request,
            candidates: Candidates::none(request.world),
            evaluator: Evaluator::new(request.world),
            receivers,
            queue: BinaryHeap::new(),
            columns: vec![],
            values: vec![],
            missing,
        };
        search.run(frontier)
    }

    fn run(mut self, frontier: &Frontier<'a>) -> GroupRows {
        for (node, list) in frontier.senders() {
            let candidates = self.candidates.adopt(list);
            let lost = self.has_lost(node);
            self.open(Open { distance: 0.0, node, candidates, levels: 0, tried: f64::INFINITY, lost });
        }
        let enough =
            if self.request.resolution.opening == 0.0 { ROW_COMPLETE } else { CLUSTERED_ROW_COMPLETE };
        while let Some(next) = self.queue.pop() {
            if self.missing.iter().all(|&missing| missing <= enough) {
                break;
            }
            self.visit(next);
        }
        self.finish()
    }

    fn open(&mut self, open: Open) {
        let distance = self.receivers.viewers.distance_to(&self.request.world.nodes[open.node as usize]);
        self.queue.push(Open { distance, ..open });
    }

    /// Whether a sender or a cluster around it has lost its entry.
    fn has_lost(&self, node: u32) -> bool {
        let (Some(revised), Some(revision)) = (&self.revised, &self.request.revision) else { return false };
        let world = self.request.world;
        if revision.change.anew[world.instance_of_node(node as usize)] {
            return true;
        }
        std::iter::successors(Some(node), |&node| world.parent_of(node)).any(|node| revised.has_dropped(node))
    }

    /// Whether the change cannot affect the entries of a sender.
    fn is_as_before(&self, node: u32, lost: bool) -> bool {
        let Some(revision) = self.request.revision.as_ref().filter(|_| !lost) else { return false };
        let (world, viewers) = (self.request.world, &self.receivers.viewers);
        !revision.change.touches(world, viewers, &world.nodes[node as usize])
    }

    fn visit(&mut self, Open { node, candidates, levels, tried, lost, .. }: Open) {
        let sender = &self.request.world.nodes[node as usize];
        let viewers = &self.receivers.viewers;
        if viewers.cannot_see(sender, self.request.world) {
            return;
        }
        let lost = lost || self.revised.as_ref().is_some_and(|revised| revised.has_dropped(node));
        if self.is_as_before(node, lost) {
            return;
        }
        let viewers = &self.receivers.viewers;
        let opening = self.request.resolution.opening;
        let error = if sender.children.is_none() { 0.0 } else { self.error(sender) };
        // Lists are narrowed where this can end the search, and at least every few levels.
        let may_end = error <= opening * UNOCCLUDED_OPENING_FACTOR.max(MAX_TRIAL_ERROR_RATIO);
        let (verdict, levels) = if may_end {
            (self.candidates.occluders(candidates, viewers, sender), 0)
        } else if levels + 1 == NARROW_EVERY {
            (self.candidates.narrow(candidates, viewers, sender), 0)
        } else {
            (Verdict::Between(candidates), levels + 1)
        };
        let Verdict::Between(kept) = verdict else { return };
        let clear = kept.is_empty();
        let found = if error <= opening * if clear { UNOCCLUDED_OPENING_FACTOR } else { 1.0 } {
            self.take(node, kept.clone(), f64::INFINITY)
        } else if may_end && !clear && error <= tried * RETRY_SHRINK {
            self.take(node, kept.clone(), PARTIAL_VISIBILITY_SHARE * opening / self.slant(sender))
        } else {
            Attempt::TooMuch
        };
        if let (Attempt::TooMuch, Some(children)) = (found, sender.children) {
            let tried = if may_end { error.min(tried) } else { tried };
            for child in children {
                let candidates = kept.clone();
                self.open(Open { distance: 0.0, node: child, candidates, levels, tried, lost });
            }
        }
    }

    /// Estimated error of one entry for a cluster: an upper bound of its form factor, times its size over its distance.
    /// The unknown variation of radiosity within the cluster is left out; it is larger behind occluders, because hidden
    /// parts often differ in light from visible ones. Infinite if the cluster cannot have an entry.
    fn error(&self, sender: &Sender) -> f64 {
        if sender.polygon.is_empty() || self.request.resolution.opening == 0.0 {
            return f64::INFINITY;
        }
        let radius = sender.bounds.diagonal() / 2.0;
        let distance = self.receivers.viewers.distance_to(sender) + radius;
        if distance <= 2.0 * radius {
            return f64::INFINITY;
        }
        sender.area / (std::f64::consts::PI * distance * distance) * self.slant(sender)
    }

    /// Size over distance.
    fn slant(&self, sender: &Sender) -> f64 {
        let radius = sender.bounds.diagonal() / 2.0;
        radius / (self.receivers.viewers.distance_to(sender) + radius)
    }

    /// Adds one entry for the sender, its form factor for every receiver, unless one of them is above `most`.
    fn take(&mut self, node: u32, candidates: Range<usize>, most: f64) -> Attempt {
        let sender = &self.request.world.nodes[node as usize];
        let first = self.values.len();
        let occluders = self.candidates.slice(candidates);
        if !self.evaluator.evaluate(&self.receivers, sender, occluders, &mut self.values) {
            self.values.truncate(first);
            self.cover(node);
            return Attempt::Done;
        }
        if self.values[first..].iter().any(|&value| value > most) {
            self.values.truncate(first);
            return Attempt::TooMuch;
        }
        for (missing, value) in self.missing.iter_mut().zip(&self.values[first..]) {
            *missing -= value;
        }
        self.columns.push(node - self.request.columns.start as u32);
        self.cover(node);
        Attempt::Done
    }

    /// Removes older entries of senders inside a sender that is done.
    fn cover(&mut self, node: u32) {
        let Some(revised) = &mut self.revised else { return };
        let gone = revised.cover(self.request.world, node);
        self.missing.iter_mut().zip(gone).for_each(|(missing, gone)| *missing += gone);
    }

    /// Columns in rising order, values by receiver.
    fn finish(mut self) -> GroupRows {
        let receivers = self.receivers.count();
        let computed = self.values.len();
        let mut is_changed = true;
        if let Some(revised) = &self.revised {
            is_changed = computed > 0 || !revised.is_unchanged();
            for (node, values) in revised.entries() {
                self.columns.push(node - self.request.columns.start as u32);
                self.values.extend(values);
            }
        }
        let mut order: Vec<usize> = (0..self.columns.len()).collect();
        order.sort_unstable_by_key(|&k| self.columns[k]);
        let columns = order.iter().map(|&k| self.columns[k]).collect();
        let row = |i: usize| order.iter().map(move |&k| (k, i));
        let values: Vec<f64> =
            (0..receivers).flat_map(row).map(|(k, i)| self.values[k * receivers + i]).collect();
        let width = order.len();
        let sums = (0..receivers).map(|i| values[i * width..(i + 1) * width].iter().sum()).collect();
        GroupRows { group: RowGroup { columns, values, receivers }, sums, computed, is_changed }
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
