//! The scene as the last run on its file left it in the cache, whose blocks of counted rays an edit brings up to date.

use crate::equation::coupling::Coupler;
use equilux_bake::geometry::aabb::Aabb;
use equilux_bake::oven::placed_keys::PlacedKeys;
use equilux_bake::rays::scenery::Scenery;
use equilux_bake::rays::surfaces::Surfaces;
use equilux_formats::Result;
use equilux_formats::baked::BakedGeometry;
use equilux_formats::fingerprint::Key;
use equilux_formats::store::Lookup;
use std::collections::hash_map::Entry;
use std::collections::{HashMap, VecDeque};
use std::sync::Arc;

/// An earlier version of a scene.
#[derive(Debug)]
pub struct EarlierScene {
    /// The keys of its blocks.
    pub keys: PlacedKeys,
    /// Its surfaces.
    pub scenery: Scenery,
    /// For each of its instances the present one with the same part and placement; numbers rise.
    pub stays: Vec<Option<usize>>,
    /// For each present instance its number here.
    numbers: Vec<Option<usize>>,
}

/// Above this share of instances that came or went, rows from nothing cost no more.
const MOST_CHANGED: f64 = 0.5;

impl EarlierScene {
    /// The scene of the last run, if it differs from the present one, not too much, and its parts are still known.
    pub fn last(coupler: &Coupler, scenery: &Scenery) -> Option<Self> {
        let now = coupler.keys.scene.as_ref()?;
        let last =
            coupler.store.last_manifest(&coupler.scene_name()).filter(|last| last.key() != now.key())?;
        let keys = coupler.keys.earlier(&last)?;
        let stays = stays(&keys, &coupler.keys);
        let kept = stays.iter().flatten().count();
        let changed = (keys.instances.len() + coupler.keys.instances.len() - 2 * kept) as f64;
        if changed > MOST_CHANGED * coupler.keys.instances.len() as f64 {
            return None;
        }
        let mut known: HashMap<Key, Arc<Surfaces>> = HashMap::new();
        for number in 0..coupler.keys.instances.len() {
            known
                .entry(coupler.keys.part_of(number).key)
                .or_insert_with(|| scenery.shared_surfaces_of(number));
        }
        for part in &keys.parts {
            if let Entry::Vacant(unknown) = known.entry(part.key) {
                let Lookup::Found(baked) = coupler.store.load::<BakedGeometry>(&part.key) else {
                    return None;
                };
                unknown.insert(Arc::new(Surfaces::new(&baked.geometry)));
            }
        }
        if keys.parts.iter().any(|part| known[&part.key].unknowns() != part.senders) {
            return None;
        }
        let placed = keys.instances.iter().enumerate();
        let placed = placed.map(|(k, instance)| (known[&keys.part_of(k).key].clone(), instance.placement));
        let mut numbers = vec![None; coupler.keys.instances.len()];
        stays.iter().enumerate().for_each(|(number, stays)| {
            if let Some(now) = *stays {
                numbers[now] = Some(number);
            }
        });
        Some(Self { scenery: Scenery::new(placed), keys, stays, numbers })
    }

    /// The number that a present instance had.
    pub fn number_of(&self, instance: usize) -> Option<usize> {
        self.numbers[instance]
    }
}

/// What changed since the last run, as far as is known.
#[derive(Debug, Clone, Copy, Default)]
pub struct Since<'a> {
    /// The scene of the last run, if it was another.
    earlier: Option<&'a EarlierScene>,
    /// Boxes around what came or went, in scene coordinates.
    changed: &'a [Aabb],
}

impl<'a> Since<'a> {
    /// The change from an earlier scene, within these boxes.
    pub fn new(earlier: &'a EarlierScene, changed: &'a [Aabb]) -> Self {
        Self { earlier: Some(earlier), changed }
    }

    /// Boxes around what came or went, in scene coordinates.
    pub fn changed(&self) -> &'a [Aabb] {
        self.changed
    }

    /// The keys and the number that a present instance had; none if it was not there.
    pub fn before<'b>(&self, coupler: &'b Coupler, instance: usize) -> Option<(&'b PlacedKeys, usize)>
    where
        'a: 'b,
    {
        match self.earlier {
            None => Some((&coupler.keys, instance)),
            Some(earlier) => Some((&earlier.keys, earlier.number_of(instance)?)),
        }
    }
}

/// Remembers the present scene for the next run.
pub fn remember(coupler: &Coupler) -> Result<()> {
    coupler.keys.scene.as_ref().map_or(Ok(()), |scene| coupler.store.remember(&coupler.scene_name(), scene))
}

/// For each earlier instance the present one with the same part and placement.
fn stays(before: &PlacedKeys, now: &PlacedKeys) -> Vec<Option<usize>> {
    let identity = |keys: &PlacedKeys, k: usize| {
        let placement = keys.instances[k].placement.to_cols_array();
        (keys.part_of(k).key, placement.map(|number| (number + 0.0).to_bits()))
    };
    let mut free: HashMap<_, VecDeque<usize>> = HashMap::new();
    (0..now.instances.len()).for_each(|k| free.entry(identity(now, k)).or_default().push_back(k));
    let mut least = 0;
    let mut find = |k: usize| {
        // Ties between hits are broken by number: instances that changed places are not the same.
        let found = free.get_mut(&identity(before, k))?.pop_front().filter(|&found| found >= least)?;
        least = found + 1;
        Some(found)
    };
    (0..before.instances.len()).map(&mut find).collect()
}
