//! Rows by rays beside exact ones: the irradiance of a sample of unknowns, gathered with exact form factors at places over their
//! open areas from the same radiosity. What differs is the noise of the rows, the light of sources and what rays overlook.

use super::sample::{ExactRows, evenly};
use crate::equation::Equation;
use crate::gather::points::{Place, located};
use equilux_bake::monitor::Monitor;
use equilux_bake::rays::areas::Cover;
use equilux_bake::rays::scenery::Scenery;
use equilux_formats::{Element, Rgb};
use std::time::{Duration, Instant};

/// Places on an unknown along each of two directions, for light of surfaces and sky.
const PLACES: usize = 8;

/// The same for light of lamps, emitting surfaces and suns, which varies more and costs less.
const SHARP_PLACES: usize = 2 * PLACES;

/// Cost of an unknown, in exact rows.
pub const ROWS_PER_UNKNOWN: f64 = 1.5 * (PLACES * PLACES) as f64;

/// Unknowns that are gathered together; stop requests are checked between batches.
const BATCH: usize = 16;

/// How far rows by rays are from exact ones. Shares of the mean irradiance of the sample, the channel that is worst.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Audit {
    /// Number of unknowns.
    pub rows: usize,
    /// Root mean square of the differences.
    pub rms_over_mean: f64,
    /// The mean difference: below zero if rows by rays are too dark.
    pub bias_over_mean: f64,
    /// The largest difference.
    pub largest_over_mean: f64,
    /// Wall time.
    pub time: Duration,
}

/// Compares so many unknowns, evenly over the area. `radiosity` and `irradiance` of all elements, W/m². None if rows are exact, no
/// light arrives, or the monitor was stopped.
pub fn audit(
    equation: &Equation,
    radiosity: &[Rgb],
    irradiance: &[Rgb],
    requested: ExactRows,
    monitor: &Monitor,
) -> Option<Audit> {
    let placed = &equation.placed;
    let scenery = placed.scenery.as_ref()?;
    let start = Instant::now();
    let chosen = evenly(equation, requested.of(placed.columns()));
    let elements = &placed.world.elements;
    monitor.begin("exact rows beside those by rays", chosen.len(), ROWS_PER_UNKNOWN * chosen.len() as f64);
    let gather = equation.gather(radiosity);
    let mut pairs: Vec<[Rgb; 2]> = vec![];
    for batch in chosen.chunks(BATCH) {
        if monitor.stopped() {
            return None;
        }
        let mean = |places: usize, light: &dyn Fn(&[Element]) -> Vec<Rgb>| {
            means(batch.iter().map(|&row| open_places(scenery, row, places)).collect(), elements, light)
        };
        let reflected = mean(PLACES, &|points| gather.exact_reflected(points));
        let sharp = mean(SHARP_PLACES, &|points| gather.sharp(points));
        for ((&(instance, unknown), reflected), sharp) in batch.iter().zip(reflected).zip(sharp) {
            let own = placed.world.elements_of(instance);
            let element =
                own.clone().find(|element| placed.unknown_of(instance, element - own.start) == unknown);
            let exact = reflected.zip(sharp).map(|(reflected, sharp)| reflected + sharp);
            pairs.extend(element.zip(exact).map(|(element, exact)| [irradiance[element], exact]));
        }
        monitor.advance(batch.len());
    }
    statistics(&pairs).map(|audit| Audit { time: start.elapsed(), ..audit })
}

/// The mean light at each of some lists of places; none where a list has none on a surface.
fn means(
    places: Vec<Vec<Place>>,
    elements: &[Element],
    light: &dyn Fn(&[Element]) -> Vec<Rgb>,
) -> Vec<Option<Rgb>> {
    let found = located(elements, &places.concat());
    let points: Vec<Element> = found.iter().flatten().map(|&(point, _)| point).collect();
    let (mut light, mut found) = (light(&points).into_iter(), found.iter());
    let mean = |places: &Vec<Place>| {
        let own = found.by_ref().take(places.len()).flatten().count();
        let sum = light.by_ref().take(own).fold(Rgb::BLACK, |sum, h| sum + h);
        (own > 0).then(|| sum / own as f64)
    };
    places.iter().map(mean).collect()
}

/// Places all over an unknown that nothing covers, so many along each of two directions, in coordinates of the scene.
fn open_places(scenery: &Scenery, (instance, unknown): (usize, usize), along: usize) -> Vec<Place> {
    let emitters = scenery.surfaces_of(instance).emitters(unknown);
    let cover = Cover { scenery, instance, near: emitters.bounds().diagonal(), gap: 0.0 };
    let to_scene = scenery.placement_of(instance);
    let at = |k: usize| (k as f64 + 0.5) / along as f64;
    (0..along * along)
        .map(|k| emitters.place(at(k % along), at(k / along)))
        .filter(|&(point, normal)| !cover.is_covered(point, normal))
        .map(|(point, normal)| Place {
            point: to_scene.transform_point3(point),
            normal: to_scene.transform_vector3(normal).normalize(),
        })
        .collect()
}

/// The statistics of pairs of irradiances, by rays and exact.
fn statistics(pairs: &[[Rgb; 2]]) -> Option<Audit> {
    let count = pairs.len() as f64;
    let mean = pairs.iter().fold(Rgb::BLACK, |sum, &[_, exact]| sum + exact) / count;
    let lit: Vec<usize> = (0..3).filter(|&c| mean[c] > 0.0).collect();
    let worst = |of: &dyn Fn(usize) -> f64| {
        lit.iter().map(|&c| of(c) / mean[c]).max_by(|a, b| a.abs().total_cmp(&b.abs()))
    };
    let differences = |c: usize| pairs.iter().map(move |[by_rays, exact]| by_rays[c] - exact[c]);
    Some(Audit {
        rows: pairs.len(),
        rms_over_mean: worst(&|c| (differences(c).map(|d| d * d).sum::<f64>() / count).sqrt())?,
        bias_over_mean: worst(&|c| differences(c).sum::<f64>() / count)?,
        largest_over_mean: worst(&|c| differences(c).map(f64::abs).fold(0.0, f64::max))?,
        time: Duration::ZERO,
    })
}
