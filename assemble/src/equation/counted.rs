//! The blocks of an instance by rays: what its escaped rays meet in the scene, and its self block where another instance may
//! stand in between. Whole numbers, the same as from nothing.

use crate::equation::coupling::{Corrected, Coupled, Coupler};
use crate::gather::sky::SkyCells;
use crate::placed_parts::PlacedParts;
use equilux_bake::oven::cached::{Origin, cached};
use equilux_bake::oven::keys::{CORRECTED, COUPLING};
use equilux_bake::rays::counts::{PlacedRows, SceneColumns, may_be_blocked, placed};
use equilux_bake::rays::samples::Samples;
use equilux_bake::rays::scenery::Scenery;
use equilux_formats::{Result, Rows};
use glam::DVec3;
use std::cell::OnceCell;
use std::time::{Duration, Instant};

/// A scene for rays.
#[derive(Debug)]
pub struct RayTracer<'a> {
    /// The surfaces in their places.
    pub scenery: &'a Scenery,
    /// The rays of a row.
    pub samples: Samples,
    /// The first column of each instance.
    first: Vec<u32>,
}

impl<'a> RayTracer<'a> {
    /// These placed parts, with so many rays a row.
    pub fn new(placed: &'a PlacedParts, scenery: &'a Scenery, rays: u32) -> Self {
        let first = (0..placed.instances.len()).map(|k| placed.columns_of(k).start as u32).collect();
        Self { scenery, samples: Samples::new(rays), first }
    }
}

impl Coupler<'_> {
    /// Trace or read the blocks of one instance. Fails if the monitor was stopped.
    pub fn couple_by_rays(&self, instance: usize, tracer: &RayTracer) -> Result<Coupled> {
        let part = &self.placed.part_of(instance).part;
        let (traced, time) = (OnceCell::new(), OnceCell::new());
        let rows = || -> Result<&PlacedRows> {
            if traced.get().is_none() {
                let start = Instant::now();
                let name = &self.placed.instances[instance].name;
                let count = self.placed.unknowns_of(instance);
                self.monitor.begin(format!("rays of {name}"), count, count as f64);
                let columns = SceneColumns {
                    first: &tracer.first,
                    unknowns: self.placed.columns(),
                    cells: SkyCells::COUNT,
                    cell: &|direction: DVec3| SkyCells::towards(direction) as u32,
                };
                let alone = (&part.self_block, &part.escapes);
                let found = placed(tracer.scenery, &tracer.samples, instance, alone, columns, self.monitor)?;
                let _ = time.set(start.elapsed() * rayon::current_num_threads() as u32);
                let _ = traced.set(found);
            }
            Ok(traced.get().expect("just traced"))
        };
        let stored = |what: &str, value: &dyn Fn(&PlacedRows) -> Rows| {
            let (name, manifest) = (self.name(instance, what), self.manifest(instance, what));
            cached(self.store, &name, &manifest, self.monitor, || rows().map(value))
        };
        let (others, origin) = stored(COUPLING, &|rows| rows.others.clone())?;
        let corrected = may_be_blocked(tracer.scenery, instance, &part.escapes).then(|| {
            let own = |rows: &PlacedRows| rows.self_block.clone().unwrap_or_else(|| part.self_block.clone());
            stored(CORRECTED, &own)
        });
        let corrected = corrected.transpose()?.map(|block| self.corrected(instance, block)).transpose()?;
        let [coupling, sky] = others.parted(self.placed.columns());
        let traced = traced.get();
        let computed_by_row = traced.map_or(vec![], |rows| rows.traced.clone());
        Ok(Coupled {
            coupling,
            sky: Some(sky),
            origin,
            computed: computed_by_row.iter().map(|&rays| rays as usize).sum(),
            computed_by_row,
            corrected,
            time: time.get().copied().unwrap_or(Duration::ZERO),
        })
    }

    /// The self block of an instance with others between its surfaces, and its local equilibrium.
    fn corrected(&self, instance: usize, (self_block, origin): (Rows, Origin)) -> Result<Corrected> {
        let key = self.store.target(&self.manifest(instance, CORRECTED).key());
        let local = self.corrected_light(instance, key, &self_block)?;
        let intruders = self.intruders(instance);
        let (computed, computed_by_row, time) = (0, vec![], Duration::ZERO);
        Ok(Corrected { self_block, local, intruders, origin, computed, computed_by_row, time })
    }
}
