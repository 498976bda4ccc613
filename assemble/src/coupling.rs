//! The blocks between parts, and a part's own block where something foreign stands inside it.
//!
//! For each instance k: F_kl for all other instances l, as one block whose columns count through all elements of the
//! scene; and F_kk as baked, or computed anew with the intruders in place. Everything in the scene blocks.

use crate::hull::Hull;
use crate::placed::Placed;
use equilux_bake::cached::{Origin, cached};
use equilux_bake::form_factor::block::block;
use equilux_bake::monitor::Monitor;
use equilux_bake::oven::{KERNEL_VERSION, light_manifest, local_equilibrium};
use equilux_formats::{
    BakedLight, Content, Digest, Factors, LocalEquilibrium, Manifest, Result, Rows, Store,
};
use glam::DAffine3;
use std::path::Path;
use std::time::Duration;

/// What an instance exchanges light through.
pub struct Coupled {
    /// F_kl for all l ≠ k, `elements of k × all elements`.
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

impl Coupled {
    /// The block that instance's own light goes through.
    pub fn self_block<'a>(&'a self, baked: &'a Rows) -> &'a Rows {
        self.corrected.as_ref().map_or(baked, |c| &c.self_block)
    }

    /// The factors of the block that is in force.
    pub fn factors<'a>(&'a self, baked: &'a LocalEquilibrium) -> Option<&'a Factors> {
        self.corrected.as_ref().map_or(baked, |c| &c.local).factors.as_ref()
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
    /// Progress and the wish to stop.
    pub monitor: &'a Monitor,
}

impl Coupler<'_> {
    /// Couple one instance with all others. None if the monitor was stopped.
    pub fn couple(&self, instance: usize) -> Result<Option<Coupled>> {
        let world = &self.placed.world;
        let receivers = world.elements_of(instance);
        let others = [0..receivers.start, receivers.end..world.elements.len()];
        let mut time = Duration::ZERO;
        let found = self.block(instance, "coupling", &others, 0..world.elements.len(), &mut time)?;
        let Some((coupling, origin, _)) = found else { return Ok(None) };
        let intruders = self.intruders(instance);
        let mut corrected = None;
        if !intruders.is_empty() {
            corrected = self.correct(instance, intruders)?;
            if corrected.is_none() {
                return Ok(None);
            }
        }
        Ok(Some(Coupled { coupling, origin, corrected, time }))
    }

    /// The instances with geometry inside the hull of this one.
    fn intruders(&self, instance: usize) -> Vec<usize> {
        let hull = Hull::around(&self.placed.part_of(instance).part.geometry);
        let inverse = self.placed.instances[instance].placement.inverse();
        (0..self.placed.instances.len())
            .filter(|&other| other != instance)
            .filter(|&other| {
                let to_part = inverse * self.placed.instances[other].placement;
                self.placed.part_of(other).part.geometry.faces.iter().any(|face| hull.holds(face, to_part))
            })
            .collect()
    }

    /// The whole self block anew, with everything that stands inside.
    fn correct(&self, instance: usize, intruders: Vec<usize>) -> Result<Option<Corrected>> {
        let own = self.placed.world.elements_of(instance);
        let mut time = Duration::ZERO;
        let senders = std::slice::from_ref(&own);
        let found = self.block(instance, "corrected self block", senders, own.clone(), &mut time)?;
        let Some((self_block, origin, key)) = found else { return Ok(None) };
        // The placed emission is not in the cached light: the scale of an instance costs no equilibrium.
        let part = &self.placed.part_of(instance).part;
        let manifest = light_manifest(key, &part.optics, part.local.solver);
        let (light, _) = cached(self.store, &self.name(instance, "corrected light"), &manifest, || {
            let local = local_equilibrium(&self_block, &part.optics, part.local.solver);
            Ok(Some(BakedLight { optics: part.optics.clone(), local }))
        })?
        .expect("a local equilibrium is not stopped halfway");
        Ok(Some(Corrected { self_block, local: light.local, intruders, origin, time }))
    }

    fn block(
        &self,
        instance: usize,
        what: &str,
        senders: &[std::ops::Range<usize>],
        columns: std::ops::Range<usize>,
        time: &mut Duration,
    ) -> Result<Option<(Rows, Origin, Digest)>> {
        let manifest = self.manifest(instance, what);
        let name = self.name(instance, what);
        let found = cached(self.store, &name, &manifest, || {
            let receivers = self.placed.world.elements_of(instance);
            self.monitor.begin(format!("{what} of {}", self.placed.instances[instance].name), receivers.len());
            Ok(block(&self.placed.world, receivers, senders, columns, self.monitor).map(|timed| {
                *time = timed.time;
                timed.block
            }))
        })?;
        Ok(found.map(|(rows, origin)| (rows, origin, manifest.key().into())))
    }

    fn name(&self, instance: usize, what: &str) -> String {
        format!("{what} of instance {instance} in {}", self.file.display())
    }

    /// Everything that the block depends on: the part itself, and every other instance, its part and where it stands
    /// as seen from this one.
    fn manifest(&self, instance: usize, what: &str) -> Manifest {
        let inverse = self.placed.instances[instance].placement.inverse();
        let mut manifest = Manifest::new()
            .setting("block", what)
            .setting("kernel", KERNEL_VERSION)
            .digest("the part", self.placed.part_of(instance).key.clone());
        for (number, other) in self.placed.instances.iter().enumerate().filter(|&(n, _)| n != instance) {
            let relative = inverse * other.placement;
            let seen = Content::new()
                .bytes(self.placed.part_of(number).key.to_string())
                .f64s(&placement_numbers(relative));
            manifest = manifest.digest(format!("instance {number} ({})", other.name), seen.digest());
        }
        manifest
    }
}

fn placement_numbers(placement: DAffine3) -> [f64; 12] {
    placement.to_cols_array()
}
