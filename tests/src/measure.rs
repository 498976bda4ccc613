//! A level as one world: its rows at a resolution, what they cost, and the light they give. For measurements.

use crate::levels::furnished;
use equilux_bake::elements::{ElementSize, subdivide};
use equilux_bake::equilibrium::{added, apply, scaled};
use equilux_bake::monitor::Monitor;
use equilux_bake::treecode::{Request, Resolution, block};
use equilux_bake::world::World;
use equilux_formats::{Geometry, Optics, Part, Rgb, Rows};
use glam::DAffine3;
use std::time::Duration;

/// A furnished level, every room a part.
pub struct Level {
    /// The rooms' elements.
    pub geometries: Vec<Geometry>,
    /// Everything in one frame.
    pub world: World,
    /// Reflectance and emission of all elements.
    pub optics: Optics,
}

/// All rows of a world, one block an instance.
pub struct Measured {
    /// The blocks.
    pub blocks: Vec<Rows>,
    /// Time summed over threads.
    pub time: Duration,
    /// How far the worst row's sum is from one.
    pub defect: f64,
}

impl Level {
    /// A furnished level of so many rooms with elements of `size` metres.
    pub fn furnished(rooms: usize, size: f64) -> Self {
        Self::of(&furnished(rooms), size)
    }

    /// These parts side by side.
    pub fn of(parts: &[Part], size: f64) -> Self {
        let geometries: Vec<Geometry> =
            parts.iter().map(|p| subdivide(p, ElementSize::Metres(size))).collect();
        let world = World::new(geometries.iter().map(|g| (g, DAffine3::IDENTITY)));
        let mut optics = Optics::default();
        for (part, geometry) in parts.iter().zip(&geometries) {
            let materials = || geometry.elements.iter().map(|e| &part.materials[e.material.index()]);
            optics.reflectance.extend(materials().map(|m| m.reflectance));
            optics.emission.extend(materials().map(|m| m.emission));
        }
        Self { geometries, world, optics }
    }

    /// Every row at this resolution.
    pub fn rows(&self, resolution: Resolution) -> Measured {
        let everyone: Vec<usize> = (0..self.world.instances()).collect();
        let mut measured = Measured { blocks: vec![], time: Duration::ZERO, defect: 0.0 };
        for &receivers in &everyone {
            let request = Request {
                world: &self.world,
                receivers,
                senders: &everyone,
                columns: 0..self.world.nodes.len(),
                already: None,
                resolution,
            };
            let timed = block(&request, &Monitor::default()).expect("nobody stops it");
            measured.time += timed.time;
            let defects = timed.row_sums.iter().map(|sum| (sum - 1.0).abs());
            measured.defect = defects.fold(measured.defect, f64::max);
            measured.blocks.push(timed.block);
        }
        measured
    }

    /// The radiosity of all elements, W/m², to `error` of the brightest.
    pub fn radiosity(&self, blocks: &[Rows], error: f64) -> Vec<Rgb> {
        let Optics { reflectance, emission } = &self.optics;
        let mut radiosity = emission.clone();
        loop {
            let nodes = self.means(&radiosity);
            let irradiance = blocks.iter().flat_map(|block| apply(block, &nodes));
            let next: Vec<Rgb> =
                irradiance.zip(reflectance).zip(emission).map(|((h, &rho), &e)| added(e, scaled(rho, h))).collect();
            let most = |values: &mut dyn Iterator<Item = f64>| values.fold(0.0, f64::max);
            let change = most(&mut next.iter().zip(&radiosity).map(|(a, b)| (a[0] - b[0]).abs()));
            let brightest = most(&mut next.iter().map(|b| b[0]));
            radiosity = next;
            if change <= error * brightest {
                return radiosity;
            }
        }
    }

    /// Root-mean-square difference of two radiosities over the mean of the second, both weighted by area; first channel.
    pub fn difference(&self, radiosity: &[Rgb], reference: &[Rgb]) -> f64 {
        let (mut square, mut sum, mut area) = (0.0, 0.0, 0.0);
        for ((element, a), b) in self.world.elements.iter().zip(radiosity).zip(reference) {
            square += element.area * (a[0] - b[0]).powi(2);
            sum += element.area * b[0];
            area += element.area;
        }
        (square / area).sqrt() / (sum / area)
    }

    fn means(&self, radiosity: &[Rgb]) -> Vec<Rgb> {
        let mut nodes = Vec::with_capacity(self.world.nodes.len());
        for (instance, geometry) in self.geometries.iter().enumerate() {
            geometry.clusters.append_means(&radiosity[self.world.elements_of(instance)], &mut nodes);
        }
        nodes
    }
}
