//! The blocks between parts, and a part's own block where something foreign stands inside it.
//!
//! For each instance k: F_kl for all other instances l, as one block whose columns count through all nodes of the
//! scene; and F_kk as baked, or computed anew with the intruders in place. Everything in the scene blocks.

use crate::hull::intruders;
use crate::placed::Placed;
use equilux_bake::cached::{Origin, cached, foreseen};
use equilux_bake::keys::{CORRECTED, COUPLING, placed_manifest};
use equilux_bake::monitor::Monitor;
use equilux_bake::oven::{light_manifest, local_equilibrium};
use equilux_bake::treecode::{Request, Resolution, block};
use equilux_formats::{BakedLight, Digest, Key, LocalEquilibrium, Manifest, Result, Rows, Store};
use std::path::Path;
use std::time::Duration;

/// What an instance exchanges light through.
pub struct Coupled {
    /// F_kl for all l ≠ k, `elements of k × all nodes of the scene`.
    pub coupling: Rows,
    /// Where the coupling came from.
    pub origin: Origin,
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
        };
        let Some((coupling, origin, _, time)) = self.block(COUPLING, &request)? else { return Ok(None) };
        Ok(Some(Coupled { coupling, origin, corrected, time }))
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
        };
        let Some((self_block, origin, key, time)) = self.block(CORRECTED, &request)? else {
            return Ok(None);
        };
        // The placed emission is not in the cached light: the scale of an instance costs no equilibrium.
        let part = &self.placed.part_of(instance).part;
        let optics = self.placed.paint_of(instance);
        let manifest = light_manifest(key, &optics, part.local.solver);
        let name = self.name(instance, "corrected light");
        let (light, _) = cached(self.store, &name, &manifest, self.monitor, || {
            let local = local_equilibrium(&self_block, &part.geometry, &optics, part.local.solver);
            Ok(Some(BakedLight { optics: optics.clone(), local }))
        })?
        .expect("a local equilibrium is not stopped halfway");
        Ok(Some(Corrected { self_block, local: light.local, intruders, origin, time }))
    }

    fn block(&self, what: &str, request: &Request) -> Result<Option<(Rows, Origin, Digest, Duration)>> {
        let instance = request.receivers;
        let manifest = self.manifest(instance, what);
        let name = self.name(instance, what);
        let mut time = Duration::ZERO;
        let found = cached(self.store, &name, &manifest, self.monitor, || {
            let receivers = self.placed.world.elements_of(instance).len();
            self.monitor.begin(format!("{what} of {}", self.placed.instances[instance].name), receivers);
            Ok(block(request, self.monitor).map(|timed| {
                time = timed.time;
                timed.block
            }))
        })?;
        Ok(found.map(|(rows, origin)| (rows, origin, manifest.key().into(), time)))
    }

    fn name(&self, instance: usize, what: &str) -> String {
        format!("{what} of instance {instance} in {}", self.file.display())
    }

    fn manifest(&self, instance: usize, what: &str) -> Manifest {
        let part_keys: Vec<Key> = self.placed.parts.iter().map(|part| part.key).collect();
        placed_manifest(&self.placed.instances, &part_keys, self.resolution, instance, what)
    }
}
