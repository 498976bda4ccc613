//! The blocks between parts, and a part's own block where something foreign stands inside it.
//!
//! For each instance k: F_kl for all other instances l, as one block whose columns count through all nodes of the
//! scene; and F_kk as baked, or computed anew with the intruders in place. Everything in the scene blocks.

use crate::hull::intruders;
use crate::older::Older;
use crate::placed::Placed;
use equilux_bake::cached::{Made, Origin, cached, cached_or_revised, foreseen};
use equilux_bake::keys::{CORRECTED, COUPLING, Known, placed_manifest};
use equilux_bake::monitor::Monitor;
use equilux_bake::oven::{Baked, light_manifest, local_equilibrium};
use equilux_bake::treecode::{Request, Resolution, Timed, block};
use equilux_formats::{BakedLight, Key, LocalEquilibrium, Manifest, Result, Rows, Store};
use std::path::Path;
use std::time::Duration;

/// What an instance exchanges light through.
pub struct Coupled {
    /// F_kl for all l ≠ k, `elements of k × all nodes of the scene`.
    pub coupling: Rows,
    /// Where the coupling came from.
    pub origin: Origin,
    /// Number of form factors computed for it.
    pub computed: usize,
    /// F_kk with what stands inside the part, if anything does.
    pub corrected: Option<Corrected>,
    /// Time spent on form factors of the coupling, summed over threads.
    pub time: Duration,
}

/// A self block that is not the baked one.
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
    /// Time spent on its form factors, summed over threads.
    pub time: Duration,
}

/// Where the blocks of an instance would come from.
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

/// Computes what couples the instances of a scene, or takes it from the cache.
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
    /// Couple one instance with all others. None if the monitor was stopped.
    pub fn couple(&self, instance: usize) -> Result<Option<Coupled>> {
        let intruders = self.intruders(instance);
        let mut corrected = None;
        if !intruders.is_empty() {
            corrected = self.correct(instance, intruders)?;
            if corrected.is_none() {
                return Ok(None);
            }
        }
        let baked = &self.placed.part_of(instance).part.self_block;
        let own = corrected.as_ref().map_or(baked, |c: &Corrected| &c.self_block);
        // A row that is full already sees nothing of other parts: nothing is searched for it.
        let seen: Vec<f64> = (0..own.receivers()).map(|i| own.row_sum(i)).collect();
        let others: Vec<usize> = (0..self.placed.instances.len()).filter(|&l| l != instance).collect();
        let request = Request {
            world: &self.placed.world,
            receivers: instance,
            senders: &others,
            columns: 0..self.placed.world.nodes.len(),
            already: Some(&seen),
            resolution: self.resolution,
            revision: None,
        };
        let Some(found) = self.block(COUPLING, request, None)? else { return Ok(None) };
        let Block { rows: coupling, origin, computed, time, .. } = found;
        Ok(Some(Coupled { coupling, origin, computed, corrected, time }))
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
    fn correct(&self, instance: usize, intruders: Vec<usize>) -> Result<Option<Corrected>> {
        let request = Request {
            world: &self.placed.world,
            receivers: instance,
            senders: &[instance],
            columns: self.placed.world.nodes_of(instance),
            already: None,
            resolution: self.resolution,
            revision: None,
        };
        // The part alone is a scene too: what stands inside appeared in it.
        let part = &self.placed.part_of(instance).part;
        let alone = Older::alone(self.placed, instance, &intruders);
        let Some(found) = self.block(CORRECTED, request, Some(alone))? else { return Ok(None) };
        let Block { rows: self_block, origin, computed, key, time } = found;
        // The placed emission is not in the cached light: the scale of an instance costs no equilibrium.
        let optics = self.placed.paint_of(instance);
        let manifest = light_manifest(key.into(), &optics, part.local.solver);
        let name = self.name(instance, "corrected light");
        let (light, _) = cached(self.store, &name, &manifest, self.monitor, || {
            let local = local_equilibrium(&self_block, &part.geometry, &optics, part.local.solver);
            Ok(Some(BakedLight { optics: optics.clone(), local }))
        })?
        .expect("a local equilibrium is not stopped halfway");
        Ok(Some(Corrected { self_block, local: light.local, intruders, origin, computed, time }))
    }

    /// The block that is asked for: from the cache, or from an older one as far as what changed since cannot matter, or
    /// from `otherwise`, or from the start.
    fn block(&self, what: &str, request: Request, otherwise: Option<Older>) -> Result<Option<Block>> {
        let instance = request.receivers;
        let manifest = self.manifest(instance, what);
        let name = self.name(instance, what);
        let (mut time, mut computed) = (Duration::ZERO, 0);
        let found = cached_or_revised(self.store, &name, &manifest, self.monitor, || {
            let receivers = self.placed.world.elements_of(instance).len();
            self.monitor.begin(format!("{what} of {}", self.placed.instances[instance].name), receivers);
            let last = self.store.last_manifest(&name).and_then(|last| {
                Older::last(self.placed, self.store, instance, &last, &manifest, request.columns.clone())
            });
            let older = last.or(otherwise);
            let in_place = older.as_ref().is_some_and(|older| older.has_columns(request.columns.clone()));
            let revision = older.as_ref().map(Older::revision);
            Ok(block(&Request { revision, ..request }, self.monitor).map(|timed| {
                (time, computed) = (timed.time, timed.computed);
                made(timed, older.as_ref().map(|older| older.key.filter(|_| in_place)))
            }))
        })?;
        Ok(found.map(|(rows, origin)| {
            let key = self.store.target(&manifest.key());
            Block { rows, origin, key, computed, time }
        }))
    }

    fn name(&self, instance: usize, what: &str) -> String {
        let instances = &self.placed.instances;
        let name = &instances[instance].name;
        let twins = instances[..instance].iter().filter(|other| other.name == *name).count();
        format!("{what} of {name} #{twins} in {}", self.file.display())
    }

    fn manifest(&self, instance: usize, what: &str) -> Manifest {
        let known = |part: &Baked| Known { key: part.key, senders: part.part.geometry.clusters.nodes() };
        let parts: Vec<Known> = self.placed.parts.iter().map(known).collect();
        placed_manifest(&self.placed.instances, &parts, self.resolution, instance, what)
    }
}

/// A block and how it came about.
struct Block {
    rows: Rows,
    origin: Origin,
    /// The key under which it lies.
    key: Key,
    computed: usize,
    time: Duration,
}

/// What was made: of an older block, if there was one, and of the one under a key, if it is the same column by column.
fn made(timed: Timed, older: Option<Option<Key>>) -> Made<Rows> {
    match older {
        None => Made::Whole(timed.block),
        Some(Some(key)) if timed.is_unchanged => Made::AsUnder(key, timed.block),
        Some(_) => {
            let share = 100.0 * timed.computed as f64 / timed.block.stored().max(1) as f64;
            Made::Revised(timed.block, format!("{share:.1} % of its form factors"))
        }
    }
}
