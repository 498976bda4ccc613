//! Updates a block after a change of the scene. The occluders that appeared or disappeared determine, for each group of
//! receivers, which entries stay and which senders are searched again.
//!
//! Light between receivers and a sender passes through their shaft, so an entry whose shaft misses every change stays.
//! Senders that were hidden have no entry and may be visible now; therefore the update traverses both hierarchies where
//! shafts touch the change, and not the entries.

use super::viewers::Viewers;
use crate::geometry::aabb::Aabb;
use crate::geometry::shaft::Shaft;
use crate::world::{Sender, World};
use equilux_formats::rows::RowGroup;
use equilux_formats::{Geometry, Rows};
use glam::{DAffine3, DVec3};
use std::collections::{HashMap, HashSet};
use std::ops::Range;

/// The occluders that appeared in a scene or disappeared from it.
#[derive(Debug)]
pub struct Change {
    occluders: Vec<ChangedOccluder>,
    /// For each instance, whether all of its senders are searched again because it is new or was moved.
    pub anew: Vec<bool>,
}

/// A convex occluder that appeared or disappeared.
#[derive(Debug)]
struct ChangedOccluder {
    bounds: Aabb,
    corners: Vec<DVec3>,
}

/// A block to be updated.
#[derive(Debug)]
pub struct Revision<'a> {
    /// The older block of the same receivers.
    pub old: &'a Rows,
    /// The present sender of each of its columns; none if it was removed.
    pub senders: &'a [Option<u32>],
    /// The change since then.
    pub change: &'a Change,
}

impl Change {
    /// No change, in a scene of `instances` instances.
    pub fn none(instances: usize) -> Self {
        Self { occluders: vec![], anew: vec![false; instances] }
    }

    /// Adds the occluders of an instance that appeared or disappeared.
    pub fn add(&mut self, geometry: &Geometry, placement: DAffine3) {
        let occluders = World::new([(geometry, placement)]).into_occluders().all.into_iter();
        self.occluders.extend(occluders.map(|o| ChangedOccluder { bounds: o.bounds, corners: o.corners }));
    }

    /// Whether nothing changed.
    pub fn is_none(&self) -> bool {
        self.occluders.is_empty() && !self.anew.contains(&true)
    }

    /// Whether light from the sender to the viewers may have changed.
    pub fn touches(&self, world: &World, viewers: &Viewers, sender: &Sender) -> bool {
        let mut shaft = Shaft::between(viewers.bounds, sender.bounds);
        if let Some(flat) = &viewers.flat {
            shaft.bound(viewers.hull[0], -flat.normal);
        }
        if let Some(side) = sender.side {
            shaft.bound(world.faces[side.face.index()].corners[0], -side.normal);
        }
        let touches = |occluder: &ChangedOccluder| {
            !shaft.misses_box(&occluder.bounds)
                && (occluder.corners.is_empty() || !shaft.misses(&occluder.corners))
        };
        self.occluders.iter().any(touches)
    }
}

impl Revision<'_> {
    /// Whether every column with entries keeps its number in a block with these columns.
    pub fn is_in_place(&self, columns: &Range<usize>) -> bool {
        let stays = |column: usize| self.senders[column] == Some((columns.start + column) as u32);
        self.old.senders() == columns.len() && self.old.senders_seen().all(stays)
    }

    /// The rows of receivers that the change does not affect, with columns that count from the node `first_column`;
    /// none if one of their senders was removed.
    pub fn untouched(&self, first_column: usize, elements: &Range<usize>) -> Option<RowGroup> {
        let group = self.old.group_of(elements.start);
        let (columns, values) = self.old.values_of(group);
        let sender = |&column: &u32| self.senders[column as usize];
        let senders = columns.iter().map(sender).collect::<Option<Vec<u32>>>()?;
        // Senders are in order unless instances changed their order.
        if !senders.is_sorted() {
            return None;
        }
        let columns = senders.iter().map(|node| node - first_column as u32).collect();
        Some(RowGroup { columns, values, receivers: self.old.receivers_of(group).len() })
    }
}

/// A group of rows during its update. Values by receiver.
#[derive(Debug)]
pub struct Revised<'a> {
    revision: &'a Revision<'a>,
    group: usize,
    /// All old values, `receivers × columns`.
    values: Vec<f64>,
    /// The old columns that stay, by their sender.
    kept: HashMap<u32, usize>,
    /// Senders whose old entries were dropped.
    dropped: HashSet<u32>,
}

impl<'a> Revised<'a> {
    /// The group of some receivers.
    pub fn new(
        world: &World,
        revision: &'a Revision<'a>,
        viewers: &Viewers,
        elements: &Range<usize>,
    ) -> Self {
        let group = revision.old.group_of(elements.start);
        let (columns, values) = revision.old.values_of(group);
        let (mut kept, mut dropped) = (HashMap::new(), HashSet::new());
        for (place, &column) in columns.iter().enumerate() {
            let Some(sender) = revision.senders[column as usize] else { continue };
            let node = &world.nodes[sender as usize];
            let anew = revision.change.anew[world.instance_of_node(sender as usize)];
            if anew || revision.change.touches(world, viewers, node) {
                dropped.insert(sender);
            } else {
                kept.insert(sender, place);
            }
        }
        Self { revision, group, values, kept, dropped }
    }

    fn receivers(&self) -> usize {
        self.revision.old.receivers_of(self.group).len()
    }

    /// The values of an old column.
    fn column(&self, place: usize) -> impl Iterator<Item = f64> + '_ {
        let width = self.values.len() / self.receivers();
        (0..self.receivers()).map(move |i| self.values[i * width + place])
    }

    /// The row sums of the entries that stay.
    pub fn seen(&self) -> Vec<f64> {
        let mut seen = vec![0.0; self.receivers()];
        // In order, so that rounding does not depend on the hash.
        let mut places: Vec<usize> = self.kept.values().copied().collect();
        places.sort_unstable();
        for place in places {
            seen.iter_mut().zip(self.column(place)).for_each(|(seen, value)| *seen += value);
        }
        seen
    }

    /// Whether a sender itself has lost its entry.
    pub fn has_dropped(&self, sender: u32) -> bool {
        self.dropped.contains(&sender)
    }

    /// Whether the rows stay as they are.
    pub fn is_unchanged(&self) -> bool {
        self.dropped.is_empty() && self.kept.len() * self.receivers() == self.values.len()
    }

    /// Removes the entries of all nodes inside a sender that has got an entry. Returns the sum of the removed entries
    /// for each receiver.
    pub fn cover(&mut self, world: &World, sender: u32) -> Vec<f64> {
        let mut gone = vec![0.0; self.receivers()];
        let mut open = vec![sender];
        while let Some(node) = open.pop() {
            if let Some(place) = self.kept.remove(&node) {
                gone.iter_mut().zip(self.column(place)).for_each(|(gone, value)| *gone += value);
            } else if let Some(children) = world.nodes[node as usize].children {
                open.extend(children);
            }
        }
        gone
    }

    /// The entries that stay: senders, in order, with their values.
    pub fn entries(&self) -> Vec<(u32, Vec<f64>)> {
        let mut entries: Vec<(u32, Vec<f64>)> =
            self.kept.iter().map(|(&sender, &place)| (sender, self.column(place).collect())).collect();
        entries.sort_unstable_by_key(|entry| entry.0);
        entries
    }
}
