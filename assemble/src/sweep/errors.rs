//! The error of light at points: the root mean square difference from a reference over area, divided by the mean, of the
//! worst of the three channels. The variance of the reference's own noise, which is independent of it, is subtracted.

use super::reference::Reference;
use super::run::PointLight;
use equilux_formats::Rgb;
use serde::Serialize;

/// The two errors of a run, as shares of the mean.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Errors {
    /// Of the irradiance of flat elements.
    pub elements: f64,
    /// Of the irradiance gathered at the points.
    pub gathered: f64,
}

impl Errors {
    /// The errors of a run's light against the reference. Points on no surface do not count.
    pub fn of(light: &[Option<PointLight>], reference: &Reference) -> Self {
        let error = |of: &dyn Fn(&PointLight) -> Rgb| {
            error(light.iter().map(|point| point.as_ref().map(of)), reference)
        };
        Self { elements: error(&|point| point.element), gathered: error(&|point| point.gathered) }
    }

    /// The difference between the light of two runs at the same points; `areas` as in [`Reference`].
    pub fn between(light: &[Option<PointLight>], other: &[Option<PointLight>], areas: &[f64]) -> Self {
        let error = |of: &dyn Fn(&PointLight) -> Rgb| {
            let other = other.iter().map(|point| point.as_ref().map(of));
            error(light.iter().map(|point| point.as_ref().map(of)), &Reference::without_noise(areas, other))
        };
        Self { elements: error(&|point| point.element), gathered: error(&|point| point.gathered) }
    }
}

/// The error of the irradiance (W/m²) that is known at the points.
fn error(known: impl Iterator<Item = Option<Rgb>>, reference: &Reference) -> f64 {
    let known: Vec<(usize, Rgb)> = known.enumerate().filter_map(|(k, known)| Some((k, known?))).collect();
    let of = |c: usize| {
        let (mut squares, mut noise, mut sum, mut area) = (0.0, 0.0, 0.0, 0.0);
        for &(k, known) in &known {
            let weight = reference.areas[k];
            squares += weight * (known[c] - reference.irradiance[k][c]).powi(2);
            noise += weight * reference.noise[k][c].powi(2);
            sum += weight * reference.irradiance[k][c];
            area += weight;
        }
        // A channel without light has no mean to measure an error in.
        if sum > 0.0 { ((squares - noise).max(0.0) / area).sqrt() / (sum / area) } else { 0.0 }
    };
    (0..3).map(of).fold(0.0, f64::max)
}
