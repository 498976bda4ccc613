//! Baked parts placed in a scene: the world of all elements, and each instance's part, optics and local equilibrium.

use equilux_bake::elements::repainted;
use equilux_bake::oven::cached::Origin;
use equilux_bake::oven::{Baked, Oven};
use equilux_bake::world::World;
use equilux_formats::baked::LocalEquilibrium;
use equilux_formats::{Instance, Optics, Result};

/// The parts of a scene at their placements.
#[derive(Debug)]
pub struct PlacedParts {
    /// All elements and faces in scene coordinates, instance after instance.
    pub world: World,
    /// The distinct parts.
    pub parts: Vec<Baked>,
    /// The instances with their placements.
    pub instances: Vec<Instance>,
    /// The local equilibrium of each instance whose repainting changes its optics; none where that of the part holds.
    pub relit: Vec<Option<Relit>>,
}

/// The local equilibrium of a repainted instance.
#[derive(Debug)]
pub struct Relit {
    /// The local equilibrium and its factors.
    pub local: LocalEquilibrium,
    /// Whether it was computed or reused, and why.
    pub origin: Origin,
}

impl PlacedParts {
    /// Place the parts at the instances' placements.
    pub fn new(parts: Vec<Baked>, instances: Vec<Instance>) -> Self {
        let world = stage(&parts, &instances);
        let relit = instances.iter().map(|_| None).collect();
        Self { world, parts, instances, relit }
    }

    /// A new copy of the world, to which objects can be added.
    pub fn stage(&self) -> World {
        stage(&self.parts, &self.instances)
    }

    /// Compute, or read from the cache, the local equilibria of the repainted instances that `which` selects. Fails
    /// if the cache cannot be used or the run was stopped.
    pub fn relight(&mut self, oven: &Oven, which: impl Fn(usize) -> bool) -> Result<()> {
        for k in (0..self.instances.len()).filter(|&k| which(k)) {
            let relit = oven.relight(self.part_of(k), &self.instances[k])?;
            self.relit[k] = relit.map(|(local, origin)| Relit { local, origin });
        }
        Ok(())
    }

    /// The local equilibrium of an instance without intruders.
    pub fn local_of(&self, instance: usize) -> &LocalEquilibrium {
        self.relit[instance].as_ref().map_or(&self.part_of(instance).part.local, |relit| &relit.local)
    }

    /// The baked part of an instance.
    pub fn part_of(&self, instance: usize) -> &Baked {
        &self.parts[self.instances[instance].part.index()]
    }

    /// Values of all elements as one vector for each instance.
    pub fn split<T: Clone>(&self, values: &[T]) -> Vec<Vec<T>> {
        (0..self.instances.len()).map(|k| values[self.world.elements_of(k)].to_vec()).collect()
    }

    /// Reflectance and emission of an instance's elements after repainting, without its emission scale.
    pub fn paint_of(&self, instance: usize) -> Optics {
        let part = &self.part_of(instance).part;
        repainted(&part.geometry, &part.optics, &part.tints, &self.instances[instance].repainted)
    }

    /// Reflectance and emission of an instance's elements after repainting, with its emission scale.
    pub fn optics_of(&self, instance: usize) -> Optics {
        let mut optics = self.paint_of(instance);
        let scale = self.instances[instance].emission_scale;
        optics.emission.iter_mut().for_each(|emission| *emission = emission.map(|e| e * scale));
        optics
    }
}

fn stage(parts: &[Baked], instances: &[Instance]) -> World {
    World::new(instances.iter().map(|i| (&parts[i.part.index()].part.geometry, i.placement)))
}
