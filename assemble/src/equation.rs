//! From a scene to the equation that its light obeys: parts baked and placed, what couples them, and what shines on them
//! from outside. In goes a [`Job`]; out comes an [`Equation`], which the exchange solves and outputs ask for light.

use crate::classic::whole_optics;
use crate::coupling::{Coupled, Coupler};
use crate::direct::{Direct, direct, driven};
use crate::exchange::{Node, nodes};
use crate::gather::outside::lights;
use crate::gather::sky::Radiances;
use crate::gather::{Gather, Lights};
use crate::observer::Observer;
use crate::placed::Placed;
use crate::run::Job;
use equilux_bake::monitor::Monitor;
use equilux_bake::oven::prepare::Prepared;
use equilux_bake::oven::{Baked, Oven};
use equilux_bake::treecode::Resolution;
use equilux_formats::{Error, Optics, Result, Rgb, Scene, Store};

/// All that the exchange needs to know of a scene.
pub struct Equation {
    /// The parts in their places.
    pub placed: Placed,
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
    /// Compute, or take from the cache, all blocks of a scene under a sky, which is what `job` names, read. Fails if the monitor was stopped before they were complete.
    pub fn of(
        job: &Job,
        scene: &Scene,
        sky: Option<&Radiances>,
        prepared: Prepared,
        store: &Store,
        monitor: &Monitor,
        observer: &dyn Observer,
    ) -> Result<Self> {
        let stopped = || {
            let remedy = "run the same command again: what was finished is in the cache";
            Error::new(&job.scene, "stopped before the form factors were complete", "a complete run", remedy)
        };
        let resolution = job.preparation.resolution;
        let oven = Oven { store, file: &job.scene, resolution, monitor };
        observer.prepared(scene, &prepared);
        let mut placed = bake_parts(&oven, prepared, observer)?.ok_or_else(stopped)?;
        observer.placed(&placed, &scene.cameras);
        let coupled = couple(&coupler(job, &placed, store, monitor), observer)?.ok_or_else(stopped)?;
        placed.relight(&oven, |k| coupled[k].corrected.is_none())?;
        let lights = lights(&scene.lights, job.light_units, sky, &placed.world);
        let direct = direct(&coupler(job, &placed, store, monitor), &lights)?.ok_or_else(stopped)?;
        let driven = |k: usize| driven(&placed.optics_of(k), &direct.irradiance[k]);
        let driven = (0..placed.instances.len()).map(driven).collect();
        Ok(Self { optics: whole_optics(&placed), placed, coupled, lights, direct, driven, resolution })
    }

    /// The instances' shares.
    pub fn nodes(&self) -> Vec<Node<'_>> {
        nodes(&self.placed, &self.coupled, &self.driven)
    }

    /// Light of this radiosity (W/m², all elements), ready to be asked for anywhere.
    pub fn gather(&self, radiosity: &[Rgb]) -> Gather {
        Gather::new(&self.placed, &self.optics.emission, radiosity, &self.lights, self.resolution)
    }
}

fn bake_parts(oven: &Oven, prepared: Prepared, observer: &dyn Observer) -> Result<Option<Placed>> {
    oven.read_ahead(&prepared.parts);
    let mut parts: Vec<Baked> = Vec::new();
    for (number, part) in prepared.parts.iter().enumerate() {
        let Some(baked) = oven.bake(part)? else { return Ok(None) };
        observer.baked(number, &baked);
        parts.push(baked);
    }
    Ok(Some(Placed::new(parts, prepared.instances)))
}

fn coupler<'a>(job: &'a Job, placed: &'a Placed, store: &'a Store, monitor: &'a Monitor) -> Coupler<'a> {
    Coupler { placed, store, file: &job.scene, resolution: job.preparation.resolution, monitor }
}

fn couple(coupler: &Coupler, observer: &dyn Observer) -> Result<Option<Vec<Coupled>>> {
    coupler.read_ahead();
    let couple = |k: usize| {
        let coupled = coupler.couple(k)?;
        coupled.iter().for_each(|coupled| observer.coupled(k, coupled));
        Ok(coupled)
    };
    (0..coupler.placed.instances.len()).map(couple).collect()
}
