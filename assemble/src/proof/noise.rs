//! The noise of rows by rays, measured: what independent sets of rays find differs as much as a row is uncertain (Owen 1995). No
//! proof: the bound of the exchange holds for the rows as they were counted.

use super::sample::evenly;
use crate::equation::Equation;
use crate::gather::outside::frame;
use crate::gather::sky::SkyCells;
use equilux_bake::rays::replicas::replicas;
use equilux_bake::rays::samples::Samples;
use equilux_bake::rays::scenery::Landing;
use equilux_bake::rays::surfaces::End;
use equilux_formats::{Element, Rgb};
use rayon::prelude::*;
use std::ops::Range;

/// Independent sets of rays of a row.
const REPLICAS: usize = 4;

/// The noise of the irradiance of rows, in some of them.
#[derive(Debug, Clone)]
pub struct Noise {
    /// In the whole scene.
    pub whole: NoiseOfRows,
    /// In each instance.
    pub by_instance: Vec<NoiseOfRows>,
}

/// The noise of the irradiance of some rows.
#[derive(Debug, Clone, Copy)]
pub struct NoiseOfRows {
    /// Number of rows.
    pub rows: usize,
    /// Root mean square of their standard errors over the mean irradiance of all elements of the scene, or of their instance;
    /// the worst channel. 0 if no light arrives.
    pub over_mean: f64,
}

/// Rows in which noise is measured.
const ROWS: usize = 256;

/// Measures the noise of some rows, evenly over the area, with this radiosity of all elements, W/m²; none if rows are not
/// counted rays, or no light arrives.
pub fn noise(equation: &Equation, radiosity: &[Rgb], irradiance: &[Rgb]) -> Option<Noise> {
    let placed = &equation.placed;
    let (scenery, rays) = (placed.scenery.as_ref()?, equation.rays()?);
    let along = equation.start_from(&placed.split(radiosity));
    let sky = equation.lights.sky.as_ref();
    let cells = sky.map(|(dome, sends)| SkyCells::radiosity(dome, sends, frame(&placed.world).0));
    let light = |landing: Option<Landing>, direction| match landing {
        None => cells.as_ref().map_or(Rgb::BLACK, |cells| cells[SkyCells::towards(direction)]),
        Some(Landing { instance, end: End::Element(element), .. }) => {
            along[instance][placed.unknown_of(instance, element as usize)]
        }
        Some(_) => Rgb::BLACK,
    };
    let samples = Samples::new(rays);
    let chosen = evenly(equation, ROWS);
    let squares: Vec<Rgb> =
        chosen.par_iter().map(|&row| variance(replicas(scenery, &samples, row, light))).collect();
    let of = |which: Range<usize>, squares: Vec<Rgb>| {
        let over_mean = over_mean(&placed.world.elements[which.clone()], &irradiance[which], &squares);
        NoiseOfRows { rows: squares.len(), over_mean }
    };
    let own =
        |k: usize| chosen.iter().zip(&squares).filter(move |(row, _)| row.0 == k).map(|(_, &s)| s).collect();
    let by_instance = (0..placed.instances.len()).map(|k| of(placed.world.elements_of(k), own(k))).collect();
    let whole = of(0..irradiance.len(), squares);
    irradiance.iter().any(|&h| h != Rgb::BLACK).then_some(Noise { whole, by_instance })
}

/// Root mean square of standard errors over the mean irradiance of these elements, the worst channel; 0 if no light arrives.
fn over_mean(elements: &[Element], irradiance: &[Rgb], squares: &[Rgb]) -> f64 {
    let area: f64 = elements.iter().map(|element| element.area).sum();
    let mean = elements.iter().zip(irradiance).fold(Rgb::BLACK, |sum, (e, &h)| sum + h * (e.area / area));
    let sum = squares.iter().fold(Rgb::BLACK, |sum, &square| sum + square);
    let share = |c: usize| (sum[c] / squares.len().max(1) as f64).sqrt() / mean[c];
    (0..3).filter(|&c| mean[c] > 0.0).map(share).fold(0.0, f64::max)
}

/// The variance of independent values.
fn variance(values: [Rgb; REPLICAS]) -> Rgb {
    let mean = values.iter().fold(Rgb::BLACK, |sum, &value| sum + value) / REPLICAS as f64;
    let squares = values.iter().fold(Rgb::BLACK, |sum, &value| sum + (value - mean) * (value - mean));
    squares / (REPLICAS - 1) as f64
}
