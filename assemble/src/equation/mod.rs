//! From a scene to the equation that its light obeys: parts baked and placed, the blocks that couple them, and the light of
//! lamps, suns and sky. The exchange solves it; gathering evaluates its light anywhere.

pub mod coupling;
pub mod direct;
pub mod environment;
pub mod interpenetration;
pub mod intruders;
pub mod observer;
pub mod optics;
mod stale_block;

use crate::equation::coupling::{Coupled, Coupler};
use crate::equation::direct::{Direct, direct, driven};
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
use equilux_bake::oven::prepare::Prepared;
use equilux_bake::oven::{Baked, Oven};
use equilux_bake::treecode::Resolution;
use equilux_formats::{Optics, Result, Rgb, Scene};

/// All that the exchange needs to know of a scene.
#[derive(Debug)]
pub struct Equation {
    /// The parts in their places.
    pub placed: PlacedParts,
    /// What couples them, one entry an instance.
    pub coupled: Vec<Coupled>,
    /// Optics of all elements.
    pub optics: Optics,
    /// What shines from outside.
    pub lights: Lights,
    /// What of it arrives at elements.
    pub direct: Direct,
    /// Optics of each instance with what its elements reflect of that as emission.
    pub driven: Vec<Optics>,
    /// How form factors are kept.
    resolution: Resolution,
}

impl Equation {
    /// Compute, or take from the cache, all blocks of a scene under its own lights and those of `environment`. Fails if the
    /// monitor was stopped before they were complete.
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
        let coupled = couple(&coupler(oven, &placed), observer)?;
        placed.relight(oven, |k| coupled[k].corrected.is_none())?;
        let lights = lights(&scene.lights, environment.light_units, environment.sky.as_ref(), &placed.world);
        let direct = direct(&coupler(oven, &placed), &lights)?;
        let driven = |k: usize| driven(&placed.optics_of(k), &direct.irradiance[k]);
        let driven = (0..placed.instances.len()).map(driven).collect();
        let (optics, resolution) = (whole_optics(&placed), oven.resolution);
        Ok(Self { optics, placed, coupled, lights, direct, driven, resolution })
    }

    /// The equation of each instance.
    pub fn systems(&self) -> Vec<InstanceSystem<'_>> {
        systems(&self.placed, &self.coupled, &self.driven)
    }

    /// Optics of all elements, emission with what they reflect of the light of lamps, suns and sky.
    pub fn driven_optics(&self) -> Optics {
        joined(&self.driven)
    }

    /// Light of this radiosity (W/m², all elements), for evaluation at any point.
    pub fn gather(&self, radiosity: &[Rgb]) -> Gather {
        Gather::new(&self.placed, &self.optics.emission, radiosity, &self.lights, self.resolution)
    }
}

/// The equation of each instance, with these optics.
pub fn systems<'a>(
    placed: &'a PlacedParts,
    coupled: &'a [Coupled],
    optics: &'a [Optics],
) -> Vec<InstanceSystem<'a>> {
    (0..coupled.len())
        .map(|k| {
            let part = &placed.part_of(k).part;
            let self_block = coupled[k].self_block(&part.self_block);
            let answered = coupled[k].local(placed.local_of(k));
            let local = LocalSystem::new(
                self_block,
                &part.geometry.clusters,
                &optics[k].reflectance,
                part.local.solver,
                answered.factors.as_ref(),
            );
            let elements = &placed.world.elements[placed.world.elements_of(k)];
            InstanceSystem {
                optics: optics[k].clone(),
                self_block,
                clusters: &part.geometry.clusters,
                coupling: &coupled[k].coupling,
                local,
                answers: &answered.answers,
                areas: elements.iter().map(|element| element.area).collect(),
            }
        })
        .collect()
}

/// Rows of the scene's blocks, and what the exchange costs beside them.
fn expected_rows(prepared: &Prepared, environment: &Environment) -> f64 {
    let parts: usize = prepared.parts.iter().map(|part| part.geometry.elements.len()).sum();
    let elements = prepared.elements();
    let sky = if environment.sky.is_some() { elements } else { 0 };
    (parts + elements + sky) as f64 + ROWS_PER_ELEMENT * elements as f64
}

fn bake_parts(oven: &Oven, prepared: Prepared, observer: &dyn Observer) -> Result<PlacedParts> {
    oven.read_ahead(&prepared.parts);
    let mut parts: Vec<Baked> = Vec::new();
    for (number, part) in prepared.parts.iter().enumerate() {
        let baked = oven.bake(part)?;
        observer.baked(number, &baked);
        parts.push(baked);
    }
    Ok(PlacedParts::new(parts, prepared.instances))
}

fn coupler<'a>(oven: &'a Oven, placed: &'a PlacedParts) -> Coupler<'a> {
    let &Oven { store, file, resolution, monitor } = oven;
    Coupler { placed, store, file, resolution, monitor }
}

fn couple(coupler: &Coupler, observer: &dyn Observer) -> Result<Vec<Coupled>> {
    coupler.read_ahead();
    let couple = |k: usize| {
        let coupled = coupler.couple(k)?;
        observer.coupled(k, &coupled);
        if coupled.origin.is_reused() {
            coupler.monitor.spare(coupler.placed.world.elements_of(k).len() as f64);
        }
        Ok(coupled)
    };
    (0..coupler.placed.instances.len()).map(couple).collect()
}
