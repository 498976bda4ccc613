//! Baked parts placed in a scene: the world of all elements, and each instance's part, optics and local equilibrium.

use equilux_bake::elements::repainted;
use equilux_bake::oven::cached::Origin;
use equilux_bake::oven::{Baked, Oven};
use equilux_bake::rays::scenery::Scenery;
use equilux_bake::rays::surfaces::Surfaces;
use equilux_bake::world::World;
use equilux_formats::baked::LocalEquilibrium;
use equilux_formats::{Instance, Optics, Result, Rgb};
use rayon::prelude::*;
use std::ops::Range;
use std::sync::Arc;

/// The parts of a scene at their placements.
#[derive(Debug)]
pub struct PlacedParts {
    /// All elements and faces in scene coordinates, instance after instance.
    pub world: World,
    /// The distinct parts.
    pub parts: Vec<Baked>,
    /// The instances with their placements.
    pub instances: Vec<Instance>,
    /// All instances for rays, if rows are counted rays.
    pub scenery: Option<Arc<Scenery>>,
    /// The columns of each instance in the blocks of the scene: its unknowns, then its clusters.
    columns: Vec<Range<usize>>,
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
        let by_rays = parts.iter().any(|baked| baked.part.geometry.patches.is_some());
        let scenery = by_rays.then(|| Arc::new(scenery(&parts, &instances)));
        let nodes = instances.iter().map(|i| parts[i.part.index()].part.geometry.unknowns().nodes());
        let columns = ranges(nodes);
        Self { world, parts, instances, scenery, columns, relit }
    }

    /// Whether rows are counted rays.
    pub fn is_by_rays(&self) -> bool {
        self.scenery.is_some()
    }

    /// The columns of an instance in the blocks of the scene.
    pub fn columns_of(&self, instance: usize) -> Range<usize> {
        self.columns[instance].clone()
    }

    /// Number of columns of all instances.
    pub fn columns(&self) -> usize {
        self.columns.last().map_or(0, |last| last.end)
    }

    /// The instance that a column stands for.
    pub fn instance_of_column(&self, column: usize) -> usize {
        self.columns.partition_point(|own| own.end <= column)
    }

    /// The unknown of an element of an instance, both in the numbers of the part.
    pub fn unknown_of(&self, instance: usize, element: usize) -> usize {
        let patches = self.part_of(instance).part.geometry.patches.as_ref();
        patches.map_or(element, |patches| patches.of[element] as usize)
    }

    /// The means over an instance's unknowns of values of its elements.
    pub fn means_of_unknowns(&self, instance: usize, values: &[Rgb]) -> Vec<Rgb> {
        let geometry = &self.part_of(instance).part.geometry;
        let patches = geometry.patches.as_ref();
        patches.map_or_else(|| values.to_vec(), |patches| patches.means(&geometry.elements, values))
    }

    /// Number of unknowns of an instance.
    pub fn unknowns_of(&self, instance: usize) -> usize {
        self.part_of(instance).part.geometry.unknowns().elements()
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

/// Consecutive ranges of these lengths.
fn ranges(lengths: impl Iterator<Item = usize>) -> Vec<Range<usize>> {
    lengths
        .scan(0, |end, length| {
            *end += length;
            Some(*end - length..*end)
        })
        .collect()
}

fn scenery(parts: &[Baked], instances: &[Instance]) -> Scenery {
    let surfaces: Vec<Arc<Surfaces>> = parts.par_iter().map(Baked::surfaces).collect();
    Scenery::new(instances.iter().map(|i| (surfaces[i.part.index()].clone(), i.placement)))
}

fn stage(parts: &[Baked], instances: &[Instance]) -> World {
    World::new(instances.iter().map(|i| (&parts[i.part.index()].part.geometry, i.placement)))
}
