//! A block of an instance from an earlier version of the scene, and the changes since then. Input: the manifest of
//! the stale block, which lists every instance that existed. Output: a revision, from which the treecode brings the
//! block up to date.

use crate::placed_parts::PlacedParts;
use equilux_bake::oven::placed_keys::{RelativePlacement, placements_in};
use equilux_bake::treecode::revision::{Change, Revision};
use equilux_formats::baked::BakedGeometry;
use equilux_formats::fingerprint::{Key, Manifest};
use equilux_formats::store::Lookup;
use equilux_formats::{Geometry, Rows, Store};
use glam::DAffine3;
use std::borrow::Cow;
use std::ops::Range;

/// A block of an earlier version of the scene.
pub struct StaleBlock<'a> {
    rows: Cow<'a, Rows>,
    /// The key of the block in the cache; none for a part's own block.
    pub key: Option<Key>,
    /// The sender of each of its columns.
    senders: Vec<Option<u32>>,
    change: Change,
}

/// Above this share of added or removed instances a revision costs more than it saves.
const MAX_CHANGED_SHARE: f64 = 0.5;

impl<'a> StaleBlock<'a> {
    /// A part's own block, which lacks the intruders.
    pub fn alone(placed: &'a PlacedParts, instance: usize, intruders: &[usize]) -> Self {
        let part = &placed.part_of(instance).part;
        let mut change = Change::none(placed.instances.len());
        for &intruder in intruders {
            let geometry = &placed.part_of(intruder).part.geometry;
            change.add(geometry, placed.instances[intruder].placement);
        }
        let senders = placed.world.nodes_of(instance).map(|node| Some(node as u32)).collect();
        Self { rows: Cow::Borrowed(&part.self_block), key: None, senders, change }
    }

    /// The block that was made from the inputs in `last`, for an update to the inputs in `current`; none if it
    /// belongs to another part or was made with other settings, too much has changed, or it is no longer in the
    /// cache. `columns`: the columns of the current block.
    pub fn last(
        placed: &PlacedParts,
        store: &Store,
        instance: usize,
        last: &Manifest,
        current: &Manifest,
        columns: Range<usize>,
    ) -> Option<Self> {
        if !last.is_alike(current) {
            return None;
        }
        let (before, now) = (placements_in(last)?, placements_in(current)?);
        let stays = stays(&before, &now);
        let new = (0..now.len()).filter(|n| !stays.contains(&Some(*n)));
        let gone = (0..before.len()).filter(|&b| stays[b].is_none());
        if (new.clone().count() + gone.clone().count()) as f64 > MAX_CHANGED_SHARE * now.len() as f64 {
            return None;
        }
        let own = placed.instances[instance].placement;
        let mut change = Change::none(placed.instances.len());
        for (number, seen) in new.map(|n| &now[n]) {
            change.anew[*number] = true;
            change.add(&placed.part_of(*number).part.geometry, own * seen.placement());
        }
        for (_, seen) in gone.map(|b| &before[b]) {
            add_part(placed, store, seen.part, own * seen.placement(), &mut change)?;
        }
        let key = store.target(&last.key());
        let Lookup::Found(rows) = store.load::<Rows>(&key) else { return None };
        let senders = if columns == placed.world.nodes_of(instance) {
            columns.map(|node| Some(node as u32)).collect()
        } else {
            senders(placed, instance, &before, &now, &stays)
        };
        (senders.len() == rows.senders()).then_some(Self {
            rows: Cow::Owned(rows),
            key: Some(key),
            senders,
            change,
        })
    }

    /// The revision for the treecode.
    pub fn revision(&self) -> Revision<'_> {
        Revision { old: &self.rows, senders: &self.senders, change: &self.change }
    }
}

/// For each earlier instance, the current instance with the same part and placement, if there is one.
fn stays(before: &[(usize, RelativePlacement)], now: &[(usize, RelativePlacement)]) -> Vec<Option<usize>> {
    let mut free: Vec<bool> = vec![true; now.len()];
    let mut find = |seen: &RelativePlacement| {
        let found = (0..now.len()).find(|&n| free[n] && now[n].1 == *seen)?;
        free[found] = false;
        Some(found)
    };
    before.iter().map(|(_, seen)| find(seen)).collect()
}

fn add_part(
    placed: &PlacedParts,
    store: &Store,
    key: Key,
    placement: DAffine3,
    change: &mut Change,
) -> Option<()> {
    let known = placed.parts.iter().find(|part| part.key == key);
    let read: Geometry;
    let geometry = match known {
        Some(baked) => &baked.part.geometry,
        None => {
            let Lookup::Found(baked) = store.load::<BakedGeometry>(&key) else { return None };
            read = baked.geometry;
            &read
        }
    };
    change.add(geometry, placement);
    Some(())
}

/// The sender of each column of a coupling that was made with the instances `before`.
fn senders(
    placed: &PlacedParts,
    instance: usize,
    before: &[(usize, RelativePlacement)],
    now: &[(usize, RelativePlacement)],
    stays: &[Option<usize>],
) -> Vec<Option<u32>> {
    let nodes_of = |k: usize| placed.world.nodes_of(k).map(|node| Some(node as u32));
    // The instance itself has the number that is missing among the others.
    let own = (0..).zip(before).find(|(n, (number, _))| n != number).map_or(before.len(), |(n, _)| n);
    let mut senders = Vec::new();
    for (place, (_, seen)) in before.iter().enumerate() {
        if place == own {
            senders.extend(nodes_of(instance));
        }
        match stays[place] {
            Some(n) => senders.extend(nodes_of(now[n].0)),
            None => senders.extend(std::iter::repeat_n(None, seen.senders)),
        }
    }
    if own == before.len() {
        senders.extend(nodes_of(instance));
    }
    senders
}
