//! The radiosity equation of a scene: baked and placed parts, the blocks that couple them, and the light of lamps,
//! suns and sky. The exchange solves it; `gather` evaluates its light at any point.

mod counted;
pub mod coupling;
pub mod direct;
mod direct_by_rays;
mod earlier;
pub mod environment;
pub mod facing;
pub mod interpenetration;
pub mod intruders;
pub mod observer;
pub mod optics;
pub mod reflected;
mod source_rows;
pub mod sources;
mod stale_block;

use crate::equation::counted::RayTracer;
use crate::equation::coupling::{Coupled, Coupler};
use crate::equation::direct::{Direct, direct, driven};
use crate::equation::direct_by_rays::DirectByRays;
use crate::equation::environment::Environment;
use crate::equation::observer::Observer;
use crate::equation::optics::{joined, whole_optics};
use crate::exchange::ROWS_PER_ELEMENT;
use crate::exchange::system::InstanceSystem;
use crate::gather::Gather;
use crate::gather::lights::Lights;
use crate::gather::outside::lights;
use crate::placed_parts::PlacedParts;
use equilux_bake::equilibrium::LocalSystem;
use equilux_bake::oven::Oven;
use equilux_bake::oven::own_order::in_own_order;
use equilux_bake::oven::prepare::Prepared;
use equilux_bake::treecode::Resolution;
use equilux_formats::{Optics, Result, Rgb, Scene};

/// The complete equation of a scene.
#[derive(Debug)]
pub struct Equation {
    /// The placed parts.
    pub placed: PlacedParts,
    /// The blocks of each instance.
    pub coupled: Vec<Coupled>,
    /// Optics of all elements.
    pub optics: Optics,
    /// Lamps, suns and sky.
    pub lights: Lights,
    /// The direct irradiance of the elements.
    pub direct: Direct,
    /// Optics of each instance with emission E + ρD, with the direct irradiance D.
    pub driven: Vec<Optics>,
    /// Accuracy and storage of form factors.
    resolution: Resolution,
}

impl Equation {
    /// Compute, or read from the cache, all blocks of a scene with its own lights and those of `environment`. Fails
    /// if the monitor was stopped before the blocks were complete.
    pub fn new(
        oven: &Oven,
        scene: &Scene,
        prepared: Prepared,
        environment: &Environment,
        observer: &dyn Observer,
    ) -> Result<Self> {
        observer.prepared(scene, &prepared);
        oven.monitor.expect(expected_rows(&prepared, environment));
        let mut placed = bake_parts(oven, prepared, observer)?;
        observer.placed(&placed, &scene.cameras);
        let coupler = Coupler::new(oven, &placed);
        let lights = lights(&scene.lights, environment.light_units, environment.sky.as_ref(), &placed.world);
        let optics = whole_optics(&placed);
        let (coupled, direct) = match (&placed.scenery, oven.resolution.rays) {
            (None, _) | (_, None) => {
                (couple(&coupler, observer, |k| coupler.couple(k))?, direct(&coupler, &lights)?)
            }
            (Some(scenery), Some(rays)) => {
                let tracer = RayTracer::new(&coupler, scenery, rays);
                let edit = tracer.edit();
                let coupled =
                    couple(&coupler, observer, |k| coupler.couple_by_rays(k, &tracer, edit.as_ref()))?;
                let by_rays = DirectByRays {
                    coupler: &coupler,
                    scenery,
                    coupled: &coupled,
                    since: tracer.since(edit.as_ref()),
                    optics: &optics,
                };
                let direct = by_rays.irradiance(&lights)?;
                earlier::remember(&coupler)?;
                (coupled, direct)
            }
        };
        placed.relight(oven, |k| coupled[k].corrected.is_none())?;
        let driven = |k: usize| {
            let own = placed.part_of(k).part.geometry.optics_of_unknowns(&placed.optics_of(k));
            driven(&own, &direct.irradiance[k], &direct.apart[k])
        };
        let driven = (0..placed.instances.len()).map(driven).collect();
        Ok(Self { optics, placed, coupled, lights, direct, driven, resolution: oven.resolution })
    }

    /// Accuracy and storage of form factors.
    pub fn resolution(&self) -> Resolution {
        self.resolution
    }

    /// Rays a row, if rows are counted rays.
    pub fn rays(&self) -> Option<u32> {
        self.resolution.rays
    }

    /// The block row of each instance.
    pub fn systems(&self) -> Vec<InstanceSystem<'_>> {
        systems(&self.placed, &self.coupled, &self.driven)
    }

    /// Optics of all elements with emission E + ρD.
    pub fn driven_optics(&self) -> Optics {
        joined(&self.driven)
    }

    /// The light of this radiosity (W/m², all elements), for evaluation at any point.
    pub fn gather(&self, radiosity: &[Rgb]) -> Gather {
        Gather::new(&self.placed, &self.optics.emission, radiosity, &self.lights, self.resolution)
    }
}

/// The block row of each instance, with these optics.
pub fn systems<'a>(
    placed: &'a PlacedParts,
    coupled: &'a [Coupled],
    optics: &'a [Optics],
) -> Vec<InstanceSystem<'a>> {
    (0..coupled.len())
        .map(|k| {
            let part = &placed.part_of(k).part;
            let self_block = coupled[k].self_block(&part.self_block);
            let local_equilibrium = coupled[k].local(placed.local_of(k));
            let local = LocalSystem::new(
                self_block,
                part.geometry.unknowns(),
                &optics[k].reflectance,
                part.local.solver,
                local_equilibrium.factors.as_ref(),
            );
            let (unknowns, scale) = (part.geometry.unknowns(), placed.instances[k].scale().powi(2));
            let elements = &placed.world.elements[placed.world.elements_of(k)];
            let areas = match &part.geometry.patches {
                None => elements.iter().map(|element| element.area).collect(),
                Some(patches) => {
                    let open = |i: usize| self_block.share_of_rays(i, patches.rays);
                    (0..unknowns.elements()).map(|i| unknowns.area_of(i) * scale * open(i)).collect()
                }
            };
            InstanceSystem {
                optics: optics[k].clone(),
                self_block,
                clusters: unknowns,
                coupling: &coupled[k].coupling,
                local,
                answers: &local_equilibrium.answers,
                areas,
            }
        })
        .collect()
}

/// The expected work for blocks and exchange, in rows of form factors.
fn expected_rows(prepared: &Prepared, environment: &Environment) -> f64 {
    let parts: usize = prepared.parts.iter().map(|part| part.geometry.unknowns().elements()).sum();
    let elements = prepared.unknowns();
    let by_rays = prepared.resolution.rays.is_some();
    let sky = if environment.sky.is_some() && !by_rays { elements } else { 0 };
    (parts + elements + sky) as f64 + ROWS_PER_ELEMENT * elements as f64
}

fn bake_parts(oven: &Oven, prepared: Prepared, observer: &dyn Observer) -> Result<PlacedParts> {
    oven.read_ahead(&prepared.parts);
    let bake = |number: usize| {
        let baked = oven.bake(&prepared.parts[number])?;
        observer.baked(number, &baked);
        Ok(baked)
    };
    let parts = in_own_order(prepared.parts.len(), bake)?;
    Ok(PlacedParts::new(parts, prepared.instances))
}

fn couple(
    coupler: &Coupler,
    observer: &dyn Observer,
    couple: impl Fn(usize) -> Result<Coupled>,
) -> Result<Vec<Coupled>> {
    coupler.read_ahead();
    let couple = |k: usize| {
        let coupled = couple(k)?;
        observer.coupled(k, &coupled);
        if coupled.origin.is_reused() {
            coupler.monitor.spare(coupler.placed.unknowns_of(k) as f64);
        }
        Ok(coupled)
    };
    let count = coupler.placed.instances.len();
    // Exact blocks are made from those of alike instances before them.
    if coupler.resolution.rays.is_some() {
        in_own_order(count, couple)
    } else {
        (0..count).map(couple).collect()
    }
}
