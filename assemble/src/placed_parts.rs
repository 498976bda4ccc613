//! Baked parts placed in a scene: one world of all elements, and what each instance needs to take part.

use equilux_bake::elements::repainted;
use equilux_bake::oven::cached::Origin;
use equilux_bake::oven::{Baked, Oven};
use equilux_bake::world::World;
use equilux_formats::{Instance, LocalEquilibrium, Optics, Result};

/// The parts of a scene in their places.
#[derive(Debug)]
pub struct PlacedParts {
    /// All elements and faces in scene coordinates, instance after instance.
    pub world: World,
    /// The distinct parts.
    pub parts: Vec<Baked>,
    /// Where they stand.
    pub instances: Vec<Instance>,
    /// The own light of each instance that is repainted so that it answers light otherwise than its part.
    pub relit: Vec<Option<Relit>>,
}

/// The own light of an instance.
#[derive(Debug)]
pub struct Relit {
    /// The light, and what solves it again.
    pub local: LocalEquilibrium,
    /// Where it came from.
    pub origin: Origin,
}

impl PlacedParts {
    /// Place the parts.
    pub fn new(parts: Vec<Baked>, instances: Vec<Instance>) -> Self {
        let world = stage(&parts, &instances);
        let relit = instances.iter().map(|_| None).collect();
        Self { world, parts, instances, relit }
    }

    /// The world once more, to add things to.
    pub fn stage(&self) -> World {
        stage(&self.parts, &self.instances)
    }

    /// Find the own light of instances that are repainted, those of `which`.
    pub fn relight(&mut self, oven: &Oven, which: impl Fn(usize) -> bool) -> Result<()> {
        for k in (0..self.instances.len()).filter(|&k| which(k)) {
            let relit = oven.relight(self.part_of(k), &self.instances[k])?;
            self.relit[k] = relit.map(|(local, origin)| Relit { local, origin });
        }
        Ok(())
    }

    /// The own light of an instance with nothing inside it.
    pub fn local_of(&self, instance: usize) -> &LocalEquilibrium {
        self.relit[instance].as_ref().map_or(&self.part_of(instance).part.local, |relit| &relit.local)
    }

    /// The baked part of an instance.
    pub fn part_of(&self, instance: usize) -> &Baked {
        &self.parts[self.instances[instance].part.index()]
    }

    /// Values of all elements as one vector an instance.
    pub fn split<T: Clone>(&self, values: &[T]) -> Vec<Vec<T>> {
        (0..self.instances.len()).map(|k| values[self.world.elements_of(k)].to_vec()).collect()
    }

    /// Reflectance and emission of an instance's elements as it is repainted, but for its emission scale.
    pub fn paint_of(&self, instance: usize) -> Optics {
        let part = &self.part_of(instance).part;
        repainted(&part.geometry, &part.optics, &part.tints, &self.instances[instance].repainted)
    }

    /// The same with the instance's emission scale.
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
