//! The blocks between parts, and the corrected self block of a part that contains other geometry.
//!
//! For each instance k: F_kl for all other instances l, as one block whose columns count all nodes of the scene, and
//! F_kk, as baked or recomputed with the intruders present. All geometry of the scene occludes.

use crate::equation::intruders::intruders;
use crate::equation::stale_block::StaleBlock;
use crate::placed_parts::PlacedParts;
use equilux_bake::monitor::Monitor;
use equilux_bake::oven::cached::{NewValue, Origin, cached, cached_or_revised, foreseen};
use equilux_bake::oven::placed_keys::{BakedKey, CORRECTED, COUPLING, PlacedKeys, RelativePlacement};
use equilux_bake::oven::{Baked, Oven, light_manifest, local_equilibrium};
use equilux_bake::rays::counts::may_be_blocked;
use equilux_bake::treecode::{Audience, Request, Resolution, Timed, block};
use equilux_formats::baked::{BakedLight, LocalEquilibrium};
use equilux_formats::fingerprint::{Key, Manifest};
use equilux_formats::{Result, Rows, Store};
use rayon::prelude::*;
use std::collections::HashSet;
use std::ops::Range;
use std::path::Path;
use std::sync::OnceLock;
use std::time::Duration;

/// The blocks of an instance.
#[derive(Debug)]
pub struct Coupled {
    /// F_kl for all l ≠ k, `unknowns of k × columns of the scene`.
    pub coupling: Rows,
    /// Form factors to the cells of the sky, `unknowns of k × cells`, if rows are counted rays.
    pub sky: Option<Rows>,
    /// Whether the coupling was computed or reused, and why.
    pub origin: Origin,
    /// Number of form factors computed for it.
    pub computed: usize,
    /// Number of form factors, or of rays, computed for each receiver; empty if none were computed.
    pub computed_by_row: Vec<u32>,
    /// Number of rays traced for it.
    pub rays: usize,
    /// F_kk with the intruders, if there are any.
    pub corrected: Option<Corrected>,
    /// Time spent on form factors of the coupling, summed over threads.
    pub time: Duration,
}

/// The self block of an instance with intruders.
#[derive(Debug)]
pub struct Corrected {
    /// F_kk with the intruders.
    pub self_block: Rows,
    /// The local equilibrium with the intruders, and the factors of the corrected matrix.
    pub local: LocalEquilibrium,
    /// The intruders: instances with geometry inside this one's hull.
    pub intruders: Vec<usize>,
    /// Whether the block was computed or reused, and why.
    pub origin: Origin,
    /// Number of form factors computed for it.
    pub computed: usize,
    /// Number of form factors computed for each receiver; empty if none were computed.
    pub computed_by_row: Vec<u32>,
    /// Time spent on its form factors, summed over threads.
    pub time: Duration,
}

/// Which blocks of an instance a run would compute or reuse, and why.
#[derive(Debug)]
pub struct ForeseenBlocks {
    /// The intruders: instances with geometry inside this one's hull.
    pub intruders: Vec<usize>,
    /// The origin of the self block with the intruders, if there are any.
    pub corrected: Option<Origin>,
    /// The origin of the coupling.
    pub coupling: Origin,
}

impl Coupled {
    /// The self block in force: the corrected one, or else `baked`.
    pub fn self_block<'a>(&'a self, baked: &'a Rows) -> &'a Rows {
        self.corrected.as_ref().map_or(baked, |c| &c.self_block)
    }

    /// The local equilibrium in force: the corrected one, or else `baked`.
    pub fn local<'a>(&'a self, baked: &'a LocalEquilibrium) -> &'a LocalEquilibrium {
        self.corrected.as_ref().map_or(baked, |c| &c.local)
    }
}

/// Number of instances of the same part that are compared to find the most similar surroundings.
const MAX_TWIN_CANDIDATES: usize = 8;

/// Computes the blocks of a scene's instances, or reads them from the cache.
#[derive(Debug)]
pub struct Coupler<'a> {
    /// The scene.
    pub placed: &'a PlacedParts,
    /// The cache.
    pub store: &'a Store,
    /// The scene's file, part of the names under which blocks are remembered.
    pub file: &'a Path,
    /// Accuracy and storage of form factors.
    pub resolution: Resolution,
    /// Progress, and requests to stop.
    pub monitor: &'a Monitor,
    /// What keys are made of.
    pub keys: PlacedKeys,
    /// What changed in the scene since the last run, if it is asked for.
    change: OnceLock<Option<String>>,
}

impl<'a> Coupler<'a> {
    /// Computes blocks of these placed parts, which `oven` baked.
    pub fn new(oven: &Oven<'a>, placed: &'a PlacedParts) -> Self {
        let &Oven { store, file, resolution, monitor } = oven;
        let baked = |part: &Baked| BakedKey { key: part.key, senders: part.part.geometry.unknowns().nodes() };
        let parts = placed.parts.iter().map(baked).collect();
        let keys = PlacedKeys::new(placed.instances.clone(), parts, resolution);
        Self { placed, store, file, resolution, monitor, keys, change: OnceLock::new() }
    }
    /// Read in parallel all blocks, and all local equilibria with intruders, that the cache holds;
    /// [`Coupler::couple`] then requests them one after the other.
    pub fn read_ahead(&self) {
        let key = |k: usize, what: &str| self.store.target(&self.manifest(k, what).key());
        let instances = (0..self.placed.instances.len()).into_par_iter();
        let keys = instances.map(|k| (k, key(k, COUPLING), key(k, CORRECTED))).collect::<Vec<_>>();
        let stale =
            keys.par_iter().flat_map(|&(k, ..)| [COUPLING, CORRECTED].map(|what| self.last_key(k, what)));
        let stale: Vec<Key> = stale.flatten().collect();
        self.store
            .read_ahead::<Rows>(&[keys.iter().flat_map(|keys| [keys.1, keys.2]).collect(), stale].concat());
        let lights = keys.par_iter().map(|&(k, _, corrected)| {
            let solver = self.placed.part_of(k).part.local.solver;
            light_manifest(corrected.into(), &self.placed.paint_of(k), solver).key()
        });
        self.store.read_ahead::<BakedLight>(&lights.collect::<Vec<_>>());
    }

    /// Compute or read the blocks of one instance. Fails if the monitor was stopped.
    pub fn couple(&self, instance: usize) -> Result<Coupled> {
        let intruders = self.intruders(instance);
        let corrected = if intruders.is_empty() { None } else { Some(self.correct(instance, intruders)?) };
        let baked = &self.placed.part_of(instance).part.self_block;
        let own = corrected.as_ref().map_or(baked, |c: &Corrected| &c.self_block);
        let others: Vec<usize> = (0..self.placed.instances.len()).filter(|&l| l != instance).collect();
        let request =
            Request::new(&self.placed.world, Audience::Instance(instance), &others, self.resolution);
        let MadeBlock { rows: coupling, origin, computed, computed_by_row, time, .. } =
            self.block((instance, COUPLING), request, Some(own), None)?;
        Ok(Coupled { coupling, sky: None, origin, computed, computed_by_row, rays: 0, corrected, time })
    }

    /// Which blocks of an instance would be computed or reused, and why. Computes no form factors.
    pub fn foresee(&self, instance: usize) -> ForeseenBlocks {
        let origin = |what: &str| {
            let manifest = self.manifest(instance, what);
            self.explained(foreseen::<Rows>(self.store, &self.name(instance, what), &manifest))
        };
        let intruders = self.intruders(instance);
        let escapes = &self.placed.part_of(instance).part.escapes;
        let is_corrected = match &self.placed.scenery {
            Some(scenery) => !intruders.is_empty() && may_be_blocked(scenery, instance, escapes),
            None => !intruders.is_empty(),
        };
        let corrected = is_corrected.then(|| origin(CORRECTED));
        ForeseenBlocks { intruders, corrected, coupling: origin(COUPLING) }
    }

    /// The instances with geometry inside the hull of this one.
    pub fn intruders(&self, instance: usize) -> Vec<usize> {
        intruders(&self.placed.instances, |k| &self.placed.part_of(k).part.geometry, instance)
    }

    /// The self block recomputed with the intruders.
    fn correct(&self, instance: usize, intruders: Vec<usize>) -> Result<Corrected> {
        let senders = [instance];
        let request = Request::of_self(&self.placed.world, &senders, self.resolution);
        self.monitor.expect(self.placed.world.elements_of(instance).len() as f64);
        // The part's own block is that of a scene into which the intruders were added.
        let alone = StaleBlock::alone(self.placed, instance, &intruders);
        let MadeBlock { rows: self_block, origin, computed, computed_by_row, key, time } =
            self.block((instance, CORRECTED), request, None, Some(alone))?;
        if origin.is_reused() {
            self.monitor.spare(self.placed.world.elements_of(instance).len() as f64);
        }
        let local = self.corrected_light(instance, key, &self_block)?;
        Ok(Corrected { self_block, local, intruders, origin, computed, computed_by_row, time })
    }

    /// The local equilibrium of an instance with this self block, which is stored under `key`.
    pub fn corrected_light(&self, instance: usize, key: Key, self_block: &Rows) -> Result<LocalEquilibrium> {
        // The cached light excludes the emission scale, so changing the scale costs no local solve.
        let (part, optics) = (&self.placed.part_of(instance).part, self.placed.paint_of(instance));
        let manifest = light_manifest(key.into(), &optics, part.local.solver);
        let name = self.name(instance, "corrected light");
        let (light, _) = cached(self.store, &name, &manifest, self.monitor, || {
            let local = local_equilibrium(self_block, &part.geometry, &optics, part.local.solver);
            Ok(BakedLight { optics: optics.clone(), local })
        })?;
        Ok(light.local)
    }

    /// A block of an instance: read from the cache, or updated from a stale block where the changes cannot matter, or
    /// from `fallback`, or computed.
    fn block(
        &self,
        (instance, what): (usize, &str),
        request: Request,
        own: Option<&Rows>,
        fallback: Option<StaleBlock>,
    ) -> Result<MadeBlock> {
        let manifest = self.manifest(instance, what);
        let name = self.name(instance, what);
        let (mut time, mut computed, mut computed_by_row) = (Duration::ZERO, 0, vec![]);
        let found = cached_or_revised(self.store, &name, &manifest, self.monitor, || {
            let receivers = self.placed.world.elements_of(instance).len();
            self.monitor.begin(
                format!("{what} of {}", self.placed.instances[instance].name),
                receivers,
                receivers as f64,
            );
            let last = self.store.last_manifest(&name).and_then(|last| {
                StaleBlock::last(self.placed, self.store, instance, &last, &manifest, request.columns.clone())
            });
            let twin = || self.twin(instance, what, &manifest, request.columns.clone());
            let stale = last.or_else(twin).or(fallback);
            let revision = stale.as_ref().map(StaleBlock::revision);
            // A row whose self block already sums to 1 receives nothing from other parts; it is not searched.
            let sums = |own: &Rows| (0..own.receivers()).map(|i| own.row_sum(i)).collect::<Vec<_>>();
            let already = own.map(sums);
            let request = request.with_already(already.as_deref()).with_revision(revision);
            let mut timed = block(&request, self.monitor)?;
            (time, computed) = (timed.time, timed.computed);
            computed_by_row = std::mem::take(&mut timed.computed_by_row);
            Ok(made(timed, stale.as_ref().map(|stale| stale.key)))
        });
        let (rows, origin) = found?;
        let key = self.store.target(&manifest.key());
        Ok(MadeBlock { rows, origin, key, computed, computed_by_row, time })
    }

    /// The block of another instance of the same part in similar surroundings, as a stale block of this instance: the
    /// differences between the surroundings count as changes. Modular levels contain many such instances.
    fn twin(
        &self,
        instance: usize,
        what: &str,
        current: &Manifest,
        columns: Range<usize>,
    ) -> Option<StaleBlock<'_>> {
        let instances = &self.placed.instances;
        let part = instances[instance].part;
        let before = (0..instance).rev().filter(|&l| instances[l].part == part).take(MAX_TWIN_CANDIDATES);
        let seen_by = |k: usize| self.keys.placements_from(k).map(|(_, seen)| seen);
        let here: HashSet<RelativePlacement> = seen_by(instance).collect();
        let common = |l: &usize| seen_by(*l).filter(|seen| here.contains(seen)).count();
        let twin = before.max_by_key(common)?;
        let manifest = self.manifest(twin, what);
        StaleBlock::last(self.placed, self.store, instance, &manifest, current, columns)
    }

    /// The key of the last block of this name.
    fn last_key(&self, instance: usize, what: &str) -> Option<Key> {
        let last = self.store.last_manifest(&self.name(instance, what))?;
        Some(self.store.target(&last.key()))
    }

    /// The origin of a block; where the scene changed, what changed in it since the last run.
    pub fn explained(&self, origin: Origin) -> Origin {
        let Some(scene) = &self.keys.scene else { return origin };
        let find = || scene.difference(&self.store.last_manifest(&self.scene_name())?);
        let explain = |reason: String| match self.change.get_or_init(find) {
            Some(change) => reason.replace("the scene changed", change),
            None => reason,
        };
        match origin {
            Origin::Reused => Origin::Reused,
            Origin::Unchanged(reason) => Origin::Unchanged(explain(reason)),
            Origin::Computed(reason) => Origin::Computed(explain(reason)),
        }
    }

    /// The name under which the placed parts of the last run are remembered.
    pub fn scene_name(&self) -> String {
        format!("placed parts of {}", self.file.display())
    }

    /// The cache name of a block of an instance.
    pub fn name(&self, instance: usize, what: &str) -> String {
        self.keys.name(self.file, instance, what)
    }

    /// The inputs of a block of an instance.
    pub fn manifest(&self, instance: usize, what: &str) -> Manifest {
        self.keys.manifest(instance, what)
    }
}

/// A block and its origin.
struct MadeBlock {
    rows: Rows,
    origin: Origin,
    /// The key of the block in the cache.
    key: Key,
    computed: usize,
    computed_by_row: Vec<u32>,
    time: Duration,
}

/// The cache entry for a computed block: complete, revised from a stale block, or identical to the entry under the
/// stale block's key.
fn made(timed: Timed, stale: Option<Option<Key>>) -> NewValue<Rows> {
    match stale {
        None => NewValue::Whole(timed.block),
        Some(Some(key)) if timed.is_unchanged => NewValue::AsUnder(key, timed.block),
        Some(_) => {
            let share = 100.0 * timed.computed as f64 / timed.block.stored().max(1) as f64;
            NewValue::Revised(timed.block, format!("{share:.1} % of its form factors"))
        }
    }
}
