//! The blocks between parts, and a part's own block where something foreign stands inside it.
//!
//! For each instance k: F_kl for all other instances l, as one block whose columns count through all nodes of the
//! scene; and F_kk as baked, or computed anew with the intruders in place. Everything in the scene blocks.

use crate::equation::earlier::Older;
use crate::equation::intruders::intruders;
use crate::placed::Placed;
use equilux_bake::monitor::Monitor;
use equilux_bake::oven::cached::{NewValue, Origin, cached, cached_or_revised, foreseen};
use equilux_bake::oven::keys::{
    BakedKey, CORRECTED, COUPLING, RelativePlacement, placed_manifest, placements_from, sky_manifest,
};
use equilux_bake::oven::{Baked, light_manifest, local_equilibrium};
use equilux_bake::treecode::{Audience, Request, Resolution, Timed, block};
use equilux_formats::{BakedLight, Key, LocalEquilibrium, Manifest, Result, Rows, Store};
use rayon::prelude::*;
use std::collections::HashSet;
use std::ops::Range;
use std::path::Path;
use std::time::Duration;

/// What an instance exchanges light through.
#[derive(Debug)]
pub struct Coupled {
    /// F_kl for all l ≠ k, `elements of k × all nodes of the scene`.
    pub coupling: Rows,
    /// Where the coupling came from.
    pub origin: Origin,
    /// Number of form factors computed for it.
    pub computed: usize,
    /// The same, receiver by receiver; empty if there were none.
    pub computed_by_row: Vec<u32>,
    /// F_kk with what stands inside the part, if anything does.
    pub corrected: Option<Corrected>,
    /// Time spent on form factors of the coupling, summed over threads.
    pub time: Duration,
}

/// A self block that is not the baked one.
#[derive(Debug)]
pub struct Corrected {
    /// F_kk inside the scene.
    pub self_block: Rows,
    /// The equilibrium with the intruders there, and the factors of the new matrix.
    pub local: LocalEquilibrium,
    /// The instances that stand inside.
    pub intruders: Vec<usize>,
    /// Where the block came from.
    pub origin: Origin,
    /// Number of form factors computed for it.
    pub computed: usize,
    /// The same, receiver by receiver; empty if there were none.
    pub computed_by_row: Vec<u32>,
    /// Time spent on its form factors, summed over threads.
    pub time: Duration,
}

/// Where the blocks of an instance would come from.
#[derive(Debug)]
pub struct Foreseen {
    /// The instances that stand inside.
    pub intruders: Vec<usize>,
    /// The origin of the self block with what stands inside, if anything does.
    pub corrected: Option<Origin>,
    /// The origin of the coupling.
    pub coupling: Origin,
}

impl Coupled {
    /// The block that instance's own light goes through.
    pub fn self_block<'a>(&'a self, baked: &'a Rows) -> &'a Rows {
        self.corrected.as_ref().map_or(baked, |c| &c.self_block)
    }

    /// The equilibrium of the block that is in force.
    pub fn local<'a>(&'a self, baked: &'a LocalEquilibrium) -> &'a LocalEquilibrium {
        self.corrected.as_ref().map_or(baked, |c| &c.local)
    }
}

/// How many instances of the same part are compared with one, to find whose block is nearest to its own.
const TWINS: usize = 8;

/// Computes what couples the instances of a scene, or takes it from the cache.
#[derive(Debug)]
pub struct Coupler<'a> {
    /// The scene.
    pub placed: &'a Placed,
    /// The cache.
    pub store: &'a Store,
    /// The scene's file, for remembering what was coupled last.
    pub file: &'a Path,
    /// How exactly form factors are kept.
    pub resolution: Resolution,
    /// Progress and the wish to stop.
    pub monitor: &'a Monitor,
}

impl Coupler<'_> {
    /// Read at once what the cache has of all blocks and of the light with what stands inside: [`Coupler::couple`] asks for
    /// one after the other.
    pub fn read_ahead(&self) {
        let key = |k: usize, what: &str| self.store.target(&self.manifest(k, what).key());
        let instances = (0..self.placed.instances.len()).into_par_iter();
        let keys = instances.map(|k| (k, key(k, COUPLING), key(k, CORRECTED))).collect::<Vec<_>>();
        let older =
            keys.par_iter().flat_map(|&(k, ..)| [COUPLING, CORRECTED].map(|what| self.last_key(k, what)));
        let older: Vec<Key> = older.flatten().collect();
        self.store
            .read_ahead::<Rows>(&[keys.iter().flat_map(|keys| [keys.1, keys.2]).collect(), older].concat());
        let lights = keys.par_iter().map(|&(k, _, corrected)| {
            let solver = self.placed.part_of(k).part.local.solver;
            light_manifest(corrected.into(), &self.placed.paint_of(k), solver).key()
        });
        self.store.read_ahead::<BakedLight>(&lights.collect::<Vec<_>>());
    }

    /// Couple one instance with all others. Fails if the monitor was stopped.
    pub fn couple(&self, instance: usize) -> Result<Coupled> {
        let intruders = self.intruders(instance);
        let corrected = if intruders.is_empty() { None } else { Some(self.correct(instance, intruders)?) };
        let baked = &self.placed.part_of(instance).part.self_block;
        let own = corrected.as_ref().map_or(baked, |c: &Corrected| &c.self_block);
        let others: Vec<usize> = (0..self.placed.instances.len()).filter(|&l| l != instance).collect();
        let request =
            Request::new(&self.placed.world, Audience::Instance(instance), &others, self.resolution);
        let Block { rows: coupling, origin, computed, computed_by_row, time, .. } =
            self.block((instance, COUPLING), request, Some(own), None)?;
        Ok(Coupled { coupling, origin, computed, computed_by_row, corrected, time })
    }

    /// Where the blocks of an instance would come from. Computes none of them.
    pub fn foresee(&self, instance: usize) -> Foreseen {
        let origin = |what: &str| {
            let manifest = self.manifest(instance, what);
            foreseen::<Rows>(self.store, &self.name(instance, what), &manifest)
        };
        let intruders = self.intruders(instance);
        let corrected = (!intruders.is_empty()).then(|| origin(CORRECTED));
        Foreseen { intruders, corrected, coupling: origin(COUPLING) }
    }

    /// The instances with geometry inside the hull of this one.
    fn intruders(&self, instance: usize) -> Vec<usize> {
        intruders(&self.placed.instances, |k| &self.placed.part_of(k).part.geometry, instance)
    }

    /// The whole self block anew, with everything that stands inside.
    fn correct(&self, instance: usize, intruders: Vec<usize>) -> Result<Corrected> {
        let senders = [instance];
        let request = Request::of_self(&self.placed.world, &senders, self.resolution);
        self.monitor.expect(self.placed.world.elements_of(instance).len() as f64);
        // The part alone is a scene too: what stands inside appeared in it.
        let part = &self.placed.part_of(instance).part;
        let alone = Older::alone(self.placed, instance, &intruders);
        let Block { rows: self_block, origin, computed, computed_by_row, key, time } =
            self.block((instance, CORRECTED), request, None, Some(alone))?;
        if origin.is_reused() {
            self.monitor.spare(self.placed.world.elements_of(instance).len() as f64);
        }
        // The placed emission is not in the cached light: the scale of an instance costs no equilibrium.
        let optics = self.placed.paint_of(instance);
        let manifest = light_manifest(key.into(), &optics, part.local.solver);
        let name = self.name(instance, "corrected light");
        let (light, _) = cached(self.store, &name, &manifest, self.monitor, || {
            let local = local_equilibrium(&self_block, &part.geometry, &optics, part.local.solver);
            Ok(BakedLight { optics: optics.clone(), local })
        })?;
        let local = light.local;
        Ok(Corrected { self_block, local, intruders, origin, computed, computed_by_row, time })
    }

    /// The block that is asked for: from the cache, or from an older one as far as what changed since cannot matter, or
    /// from `otherwise`, or from the start.
    fn block(
        &self,
        (instance, what): (usize, &str),
        request: Request,
        own: Option<&Rows>,
        otherwise: Option<Older>,
    ) -> Result<Block> {
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
                Older::last(self.placed, self.store, instance, &last, &manifest, request.columns.clone())
            });
            let twin = || self.twin(instance, what, &manifest, request.columns.clone());
            let older = last.or_else(twin).or(otherwise);
            let revision = older.as_ref().map(Older::revision);
            // A row that is full already sees nothing of other parts: nothing is searched for it.
            let sums = |own: &Rows| (0..own.receivers()).map(|i| own.row_sum(i)).collect::<Vec<_>>();
            let already = own.map(sums);
            let request = request.with_already(already.as_deref()).with_revision(revision);
            let mut timed = block(&request, self.monitor)?;
            (time, computed) = (timed.time, timed.computed);
            computed_by_row = std::mem::take(&mut timed.computed_by_row);
            Ok(made(timed, older.as_ref().map(|older| older.key)))
        });
        let (rows, origin) = found?;
        let key = self.store.target(&manifest.key());
        Ok(Block { rows, origin, key, computed, computed_by_row, time })
    }

    /// The block of another instance of the same part that stands among much the same, as if that one were here: what one
    /// sees of the other's surroundings and the other does not is what changed. Modular levels are full of these.
    fn twin(
        &self,
        instance: usize,
        what: &str,
        wanted: &Manifest,
        columns: Range<usize>,
    ) -> Option<Older<'_>> {
        let instances = &self.placed.instances;
        let part = instances[instance].part;
        let before = (0..instance).rev().filter(|&l| instances[l].part == part).take(TWINS);
        let parts = self.known();
        let seen_by = |k: usize| placements_from(instances, &parts, k).map(|(_, seen)| seen);
        let here: HashSet<RelativePlacement> = seen_by(instance).collect();
        let common = |l: &usize| seen_by(*l).filter(|seen| here.contains(seen)).count();
        let twin = before.max_by_key(common)?;
        let manifest = self.manifest(twin, what);
        Older::last(self.placed, self.store, instance, &manifest, wanted, columns)
    }

    /// The key under which the last block of this name lies.
    fn last_key(&self, instance: usize, what: &str) -> Option<Key> {
        let last = self.store.last_manifest(&self.name(instance, what))?;
        Some(self.store.target(&last.key()))
    }

    /// What such a block of an instance is called in the cache.
    pub fn name(&self, instance: usize, what: &str) -> String {
        let instances = &self.placed.instances;
        let name = &instances[instance].name;
        let twins = instances[..instance].iter().filter(|other| other.name == *name).count();
        format!("{what} of {name} #{twins} in {}", self.file.display())
    }

    /// What the block between the sky and an instance depends on.
    pub fn sky_manifest(&self, instance: usize) -> Manifest {
        sky_manifest(&self.placed.instances, &self.known(), self.resolution, instance)
    }

    fn manifest(&self, instance: usize, what: &str) -> Manifest {
        placed_manifest(&self.placed.instances, &self.known(), self.resolution, instance, what)
    }

    fn known(&self) -> Vec<BakedKey> {
        let known = |part: &Baked| BakedKey { key: part.key, senders: part.part.geometry.clusters.nodes() };
        self.placed.parts.iter().map(known).collect()
    }
}

/// A block and how it came about.
struct Block {
    rows: Rows,
    origin: Origin,
    /// The key under which it lies.
    key: Key,
    computed: usize,
    computed_by_row: Vec<u32>,
    time: Duration,
}

/// What was made: of an older block, if there was one, and of the one under a key, if it is the same column by column.
fn made(timed: Timed, older: Option<Option<Key>>) -> NewValue<Rows> {
    match older {
        None => NewValue::Whole(timed.block),
        Some(Some(key)) if timed.is_unchanged => NewValue::AsUnder(key, timed.block),
        Some(_) => {
            let share = 100.0 * timed.computed as f64 / timed.block.stored().max(1) as f64;
            NewValue::Revised(timed.block, format!("{share:.1} % of its form factors"))
        }
    }
}
