//! The direct irradiance D of unknowns whose rows are counted rays: light of sources, of lamps and suns, and of the sky that their
//! rays see.

use crate::equation::coupling::{Coupled, Coupler};
use crate::equation::direct::{Direct, LampLight};
use crate::equation::earlier::Since;
use crate::equation::source_rows::FactorsOfSources;
use crate::equation::sources::Sources;
use crate::gather::lights::Lights;
use crate::gather::outside::frame;
use crate::gather::sky::SkyCells;
use equilux_bake::equilibrium::apply;
use equilux_bake::oven::own_order::in_own_order;
use equilux_bake::rays::Ray;
use equilux_bake::rays::scenery::Scenery;
use equilux_bake::rays::sources::{Effort, Source, form_factors, mean_over};
use equilux_formats::{Optics, Result, Rgb};
use glam::DVec3;
use rayon::prelude::*;

/// What D is computed from.
#[derive(Debug, Clone, Copy)]
pub struct DirectByRays<'a> {
    /// The scene, the cache and the monitor.
    pub coupler: &'a Coupler<'a>,
    /// The surfaces in their places.
    pub scenery: &'a Scenery,
    /// The blocks of the instances.
    pub coupled: &'a [Coupled],
    /// What changed since the last run.
    pub since: Since<'a>,
    /// Optics of all elements.
    pub optics: &'a Optics,
}

/// Places on an unknown from which a lamp is looked at.
const LAMP_PLACES: u32 = 64;

/// Values of all unknowns, one vector for each instance.
type ByInstance = Vec<Vec<Rgb>>;

impl DirectByRays<'_> {
    /// D of all unknowns. Fails if the monitor was stopped.
    pub fn irradiance(&self, lights: &Lights) -> Result<Direct> {
        let placed = self.coupler.placed;
        let LampLight { irradiance, unlit } = self.of_lamps(lights);
        let mut direct = Direct {
            irradiance: self.uncovered(&irradiance),
            apart: self.dark(),
            from_apart: self.dark(),
            sharp: self.uncovered(&irradiance),
            computed: 0,
            unlit,
        };
        self.add_sky(lights, &mut direct.irradiance);
        if let Some(sources) = Sources::emitting(placed, &self.optics.emission) {
            self.coupler.monitor.begin("light of sources", 0, 0.0);
            let seen = self.add_light(&sources, sources.emission(), &mut direct)?;
            let Direct { sharp, from_apart, .. } = &mut direct;
            sharp.iter_mut().zip(from_apart).for_each(|(sharp, light)| add(sharp, light));
            if let Some(secondary) = Sources::secondary(placed, &seen) {
                self.coupler.monitor.begin("light of secondary sources", 0, 0.0);
                let sent = secondary.means(placed, &self.first_bounce(&direct.from_apart));
                self.add_light(&secondary, &sent, &mut direct)?;
            }
        }
        Ok(direct)
    }

    /// The light of lamps and suns on all elements, each with that of its unknown.
    fn of_lamps(&self, lights: &Lights) -> LampLight {
        let elements = &self.coupler.placed.world.elements;
        let mut arriving = LampLight { irradiance: vec![Rgb::BLACK; elements.len()], unlit: vec![] };
        if !lights.lamps.is_empty() || !lights.suns.is_empty() {
            self.coupler.monitor.begin("light of lamps", 0, 0.0);
        }
        for lamp in &lights.lamps {
            let visible = |place: DVec3, normal: DVec3| {
                let light = lamp.unoccluded(place, normal);
                let ray = Ray { origin: place, direction: lamp.position - place };
                if light != Rgb::BLACK && self.scenery.is_between(&ray) { Rgb::BLACK } else { light }
            };
            let light = self.on_elements(|unknown| mean_over(self.scenery, unknown, LAMP_PLACES, visible));
            arriving.add(&lamp.name, lamp.power, elements, &light);
        }
        for sun in &lights.suns {
            let source = Source::new(sun.polygons.elements.clone());
            let light = self.on_elements(|(instance, unknown)| {
                let one = unknown..unknown + 1;
                let seen = form_factors(self.scenery, instance, one, &[(0, &source)], Effort::SUN);
                seen.iter().flatten().fold(Rgb::BLACK, |sum, &(_, value)| sum + sun.radiosity * value)
            });
            arriving.add(&sun.name, sun.power, elements, &light);
        }
        arriving
    }

    /// For each element the light of its unknown.
    fn on_elements(&self, light: impl Fn((usize, usize)) -> Rgb + Sync) -> Vec<Rgb> {
        let placed = self.coupler.placed;
        let of = |k: usize| {
            let unknowns = (0..placed.unknowns_of(k)).into_par_iter();
            let own: Vec<Rgb> = unknowns.map(|unknown| light((k, unknown))).collect();
            (0..placed.world.elements_of(k).len()).map(move |element| own[placed.unknown_of(k, element)])
        };
        (0..placed.instances.len()).flat_map(of).collect()
    }

    /// Adds what sources send to D and to what travels apart. Returns for each element the sum of its form factors to them.
    fn add_light(&self, sources: &Sources, sent: &[Rgb], direct: &mut Direct) -> Result<Vec<f64>> {
        let placed = self.coupler.placed;
        let apart = placed.split(&sources.spread(sent));
        let blocks = (self.scenery, self.coupled);
        let factors = FactorsOfSources::new(self.coupler, blocks, self.since, sources);
        let light = |k: usize| -> Result<(Vec<Rgb>, Vec<f64>, usize)> {
            let (rows, computed) = factors.rows(k)?;
            let sums = (0..rows.receivers()).map(|unknown| rows.row_sum(unknown)).collect();
            Ok((apply(&rows, sent), sums, computed))
        };
        let mut seen = Vec::with_capacity(placed.world.elements.len());
        for (k, (light, sums, computed)) in in_own_order(apart.len(), light)?.into_iter().enumerate() {
            direct.computed += computed;
            add(&mut direct.irradiance[k], &light);
            add(&mut direct.from_apart[k], &light);
            add(&mut direct.apart[k], &placed.means_of_unknowns(k, &apart[k]));
            seen.extend((0..apart[k].len()).map(|element| sums[placed.unknown_of(k, element)]));
        }
        Ok(seen)
    }

    /// ρD of all elements, W/m², with this D of unknowns.
    fn first_bounce(&self, irradiance: &[Vec<Rgb>]) -> Vec<Rgb> {
        let placed = self.coupler.placed;
        let arriving = irradiance.iter().enumerate().flat_map(|(k, own)| {
            let elements = 0..placed.world.elements_of(k).len();
            elements.map(move |element| own[placed.unknown_of(k, element)])
        });
        self.optics.reflectance.iter().zip(arriving).map(|(&rho, h)| rho * h).collect()
    }

    /// Means over unknowns of values of all elements, as averages over what is not covered.
    fn uncovered(&self, values: &[Rgb]) -> ByInstance {
        let placed = self.coupler.placed;
        let rays = self.coupler.resolution.rays.unwrap_or(1);
        let of = |(k, own): (usize, &Vec<Rgb>)| {
            let block = self.coupled[k].self_block(&placed.part_of(k).part.self_block);
            let mean = |(unknown, &mean): (usize, &Rgb)| {
                let open = block.share_of_rays(unknown, rays);
                if open > 0.0 { mean / open } else { Rgb::BLACK }
            };
            placed.means_of_unknowns(k, own).iter().enumerate().map(mean).collect()
        };
        placed.split(values).iter().enumerate().map(of).collect()
    }

    fn add_sky(&self, lights: &Lights, irradiance: &mut ByInstance) {
        let Some((dome, sends)) = &lights.sky else { return };
        let cells = SkyCells::radiosity(dome, sends, frame(&self.coupler.placed.world).0);
        for (own, coupled) in irradiance.iter_mut().zip(self.coupled) {
            coupled.sky.iter().for_each(|rows| add(own, &apply(rows, &cells)));
        }
    }

    fn dark(&self) -> ByInstance {
        let placed = self.coupler.placed;
        (0..placed.instances.len()).map(|k| vec![Rgb::BLACK; placed.unknowns_of(k)]).collect()
    }
}

fn add(sums: &mut [Rgb], light: &[Rgb]) {
    sums.iter_mut().zip(light).for_each(|(sum, &h)| *sum += h);
}
