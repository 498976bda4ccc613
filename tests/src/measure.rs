//! A level as one world, for measurements: its rows at a resolution, their cost, and the resulting light.

use crate::levels::furnished;
use equilux_assemble::classic::rays::row;
use equilux_bake::elements::{ElementSize, subdivide};
use equilux_bake::equilibrium::apply;
use equilux_bake::monitor::Monitor;
use equilux_bake::rays::RayIndex;
use equilux_bake::treecode::{Audience, Request, Resolution, block};
use equilux_bake::world::World;
use equilux_formats::{Geometry, Optics, Part, Rgb, Rows};
use glam::DAffine3;
use std::time::{Duration, Instant};

/// A furnished level, every room a part.
#[derive(Debug)]
pub struct Level {
    /// The rooms' elements.
    pub geometries: Vec<Geometry>,
    /// Everything in one frame.
    pub world: World,
    /// Reflectance and emission of all elements.
    pub optics: Optics,
}

/// All rows of a world, one block an instance.
#[derive(Debug)]
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
            let request = Request::new(&self.world, Audience::Instance(receivers), &everyone, resolution);
            let timed = block(&request, &Monitor::default()).expect("not stopped");
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
                irradiance.zip(reflectance).zip(emission).map(|((h, &rho), &e)| e + rho * h).collect();
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

/// Rows found by casting rays, the usual way: the unoccluded form factor of each pair times the share of `rays` points on
/// the sender that the receiver sees. Dense; for comparison.
#[derive(Debug)]
pub struct Cast {
    /// The receivers.
    pub receivers: Vec<usize>,
    /// Their rows, one value an element.
    pub rows: Vec<Vec<f64>>,
    /// Time on one thread.
    pub time: Duration,
}

impl Level {
    /// `count` receivers evenly through all elements.
    pub fn sample(&self, count: usize) -> Vec<usize> {
        let all = self.world.elements.len();
        (0..count.min(all)).map(|k| (2 * k + 1) * all / (2 * count.min(all))).collect()
    }

    /// The rows of some receivers with so many rays a pair.
    pub fn cast(&self, receivers: Vec<usize>, rays: usize) -> Cast {
        let elements = &self.world.elements;
        let index = RayIndex::new(elements);
        let start = Instant::now();
        let rows = receivers.iter().map(|&i| row(elements, &index, i, rays)).collect();
        Cast { receivers, rows, time: start.elapsed() }
    }

    /// Root-mean-square error of what these rows gather of `radiosity`, given what they should, over its mean.
    pub fn gather_error(&self, cast: &Cast, radiosity: &[Rgb], exact: &[f64]) -> f64 {
        let gathered =
            cast.rows.iter().map(|row| row.iter().zip(radiosity).map(|(f, b)| f * b[0]).sum::<f64>());
        let square: f64 = gathered.zip(exact).map(|(got, want)| (got - want).powi(2)).sum();
        (square / exact.len() as f64).sqrt() / (exact.iter().sum::<f64>() / exact.len() as f64)
    }

    /// Irradiance of some receivers by stored rows, W/m², first channel.
    pub fn gathered(&self, blocks: &[Rows], radiosity: &[Rgb], receivers: &[usize]) -> Vec<f64> {
        let nodes = self.means(radiosity);
        let irradiance: Vec<Rgb> = blocks.iter().flat_map(|block| apply(block, &nodes)).collect();
        receivers.iter().map(|&i| irradiance[i][0]).collect()
    }
}
