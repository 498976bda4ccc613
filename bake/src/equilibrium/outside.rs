//! A part's boundary responses: its radiosities under a few simple lights from outside. The exchange between parts uses
//! them as a coarse space.
//!
//! A receiver sees 1 − Σ_j F_ij outside its own part. Light from there is modelled as uniform, as linear in the
//! receiver's position, and as linear in its normal: seven lights in all. The slowly converging components of the
//! exchange between parts are smooth and close to a combination of the responses to these. Local responses as a coarse
//! space: Dryja & Widlund 1994; Spillane et al. 2014 for slow modes.

use super::system::LocalSystem;
use crate::geometry::aabb::Aabb;
use equilux_formats::baked::BoundaryResponses;
use equilux_formats::{Element, Geometry, Rgb};
use glam::DVec3;

/// Relative residual of a response. Responses accelerate the exchange and do not affect its result, so a rough solution
/// suffices.
const RESPONSE_RESIDUAL: f64 = 1e-2;

/// A response that is new by less than this share, compared with the span of those before it, is dropped.
const MIN_NEW_SHARE: f64 = 1e-3;

/// A smaller share that a receiver sees outside its own part is rounding of its row sum.
const MIN_OPEN_SHARE: f64 = 1e-12;

/// Where an unknown lies, and its normal.
struct Place {
    centroid: DVec3,
    normal: DVec3,
}

/// The irradiance of an unobstructed unknown under one light from outside.
type OutsideLight = Box<dyn Fn(&Place) -> f64>;

/// The places of the unknowns; of several elements the mean by area, which for a normal need not be a unit vector.
fn places(geometry: &Geometry) -> Vec<Place> {
    let place = |element: &Element| Place { centroid: element.centroid, normal: element.normal };
    let Some(patches) = &geometry.patches else { return geometry.elements.iter().map(place).collect() };
    let mut places: Vec<Place> =
        (0..patches.tree.elements()).map(|_| Place { centroid: DVec3::ZERO, normal: DVec3::ZERO }).collect();
    for (&patch, element) in patches.of.iter().zip(&geometry.elements) {
        let share = element.area / patches.tree.area_of(patch as usize);
        let place = &mut places[patch as usize];
        place.centroid += element.centroid * share;
        place.normal += element.normal * share;
    }
    places
}

/// The boundary responses of a part with this system and geometry. Empty if no light from outside arrives, or the part
/// reflects none.
pub fn boundary_responses(system: &LocalSystem, geometry: &Geometry) -> BoundaryResponses {
    let unknowns = geometry.unknowns();
    let areas: Vec<f64> = (0..unknowns.elements()).map(|i| unknowns.area_of(i)).collect();
    let places = places(geometry);
    let open: Vec<f64> = (0..areas.len()).map(|i| open(1.0 - system.block.row_sum(i))).collect();
    let mut answers = BoundaryResponses::default();
    for (number, light) in lights(&places).into_iter().enumerate() {
        let reflected = |i: usize| -> Rgb { system.reflectance[i] * (open[i] * light(&places[i])) };
        let sources: Vec<Rgb> = (0..areas.len()).map(reflected).collect();
        if sources.iter().all(|source| *source == Rgb::BLACK) {
            continue;
        }
        let (radiosity, _) = system.solve_roughly(&sources, RESPONSE_RESIDUAL);
        if number == 0 {
            answers.returned = returned(&areas, &open, &radiosity);
        }
        answers.radiosity.extend(orthonormal(radiosity, &answers.radiosity, &areas));
    }
    let images: Vec<Vec<Rgb>> = answers.radiosity.iter().map(|b| system.without_reflection(b)).collect();
    let pairs = answers.radiosity.iter().flat_map(|a| images.iter().map(|b| product(a, b, &areas)));
    answers.matrix = pairs.collect();
    answers
}

fn open(share: f64) -> f64 {
    if share > MIN_OPEN_SHARE { share } else { 0.0 }
}

/// The seven lights.
fn lights(places: &[Place]) -> Vec<OutsideLight> {
    let around = Aabb::around(places.iter().map(|place| place.centroid));
    let (centre, extent) = (around.centre(), around.size().max_element().max(f64::MIN_POSITIVE) / 2.0);
    let mut lights: Vec<OutsideLight> = vec![Box::new(|_| 1.0)];
    for axis in 0..3 {
        lights.push(Box::new(move |place: &Place| (place.centroid[axis] - centre[axis]) / extent));
        lights.push(Box::new(move |place: &Place| place.normal[axis]));
    }
    lights
}

/// The share of the power of uniform incident light that leaves the part again. By reciprocity, the weights with which
/// elements send light out are those with which they receive it.
fn returned(areas: &[f64], open: &[f64], radiosity: &[Rgb]) -> Rgb {
    let arriving: f64 = areas.iter().zip(open).map(|(area, open)| area * open).sum();
    let weights = areas.iter().zip(open).map(|(area, open)| area * open / arriving);
    weights.zip(radiosity).fold(Rgb::BLACK, |sum, (weight, b)| sum + *b * weight)
}

/// The component of `vector` orthogonal to `basis`, normalised in each channel. Channels without one are zero; none if all are.
fn orthonormal(mut vector: Vec<Rgb>, basis: &[Vec<Rgb>], areas: &[f64]) -> Option<Vec<Rgb>> {
    let before = product(&vector, &vector, areas).map(f64::sqrt);
    // Twice is enough: Giraud, Langou & Rozložník 2005.
    for _ in 0..2 {
        for known in basis {
            let along = product(&vector, known, areas);
            let pairs = vector.iter_mut().zip(known);
            pairs.for_each(|(v, &k)| *v = *v - along * k);
        }
    }
    let length = product(&vector, &vector, areas).map(f64::sqrt);
    let is_new = |c: usize| length[c] > MIN_NEW_SHARE * before[c] && length[c].is_finite();
    let share = Rgb::from_fn(|c| if is_new(c) { 1.0 / length[c] } else { 0.0 });
    vector.iter_mut().for_each(|v| *v = Rgb::from_fn(|c| if share[c] > 0.0 { v[c] * share[c] } else { 0.0 }));
    (share != Rgb::BLACK).then_some(vector)
}

/// Σ_i A_i a_i b_i, channel by channel.
fn product(a: &[Rgb], b: &[Rgb], areas: &[f64]) -> Rgb {
    let terms = areas.iter().zip(a.iter().zip(b));
    terms.fold(Rgb::BLACK, |sum, (area, (&a, &b))| sum + a * b * *area)
}
