//! Baked parts placed in a scene: one world of all elements, and what each instance needs to take part.

use equilux_bake::oven::Baked;
use equilux_bake::world::World;
use equilux_formats::{Instance, Optics};

/// The parts of a scene in their places.
pub struct Placed {
    /// All elements and faces in scene coordinates, instance after instance.
    pub world: World,
    /// The distinct parts.
    pub parts: Vec<Baked>,
    /// Where they stand.
    pub instances: Vec<Instance>,
}

impl Placed {
    /// Place the parts.
    pub fn new(parts: Vec<Baked>, instances: Vec<Instance>) -> Self {
        let geometry = |i: &Instance| (&parts[i.part.index()].part.geometry, i.placement);
        let world = World::new(instances.iter().map(geometry));
        Self { world, parts, instances }
    }

    /// The baked part of an instance.
    pub fn part_of(&self, instance: usize) -> &Baked {
        &self.parts[self.instances[instance].part.index()]
    }

    /// Values of all elements as one vector an instance.
    pub fn split<T: Clone>(&self, values: &[T]) -> Vec<Vec<T>> {
        (0..self.instances.len()).map(|k| values[self.world.elements_of(k)].to_vec()).collect()
    }

    /// Reflectance and emission of an instance's elements, its own emission scale applied.
    pub fn optics_of(&self, instance: usize) -> Optics {
        let optics = &self.part_of(instance).part.optics;
        let scale = self.instances[instance].emission_scale;
        let emission = optics.emission.iter().map(|e| e.map(|e| e * scale)).collect();
        Optics { reflectance: optics.reflectance.clone(), emission }
    }
}
