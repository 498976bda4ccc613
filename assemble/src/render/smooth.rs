//! Irradiance at the corners of elements, from the elements that share them. In go elements and the irradiance of each; out
//! comes one value a corner.
//!
//! A corner takes the mean of those around it that lie in about the same plane and whose middles see each other: neither
//! shines light through a wall that stands on a floor, nor what lies dark below a crate into the light beside it. An element
//! whose middle lies below a crate is dark all over; where it looks out it takes the light around.

use equilux_bake::visibility::rays::RayIndex;
use equilux_formats::{Element, Rgb};
use rayon::prelude::*;
use rstar::RTree;
use rstar::primitives::GeomWithData;

/// Corners that are nearer to each other than this share of an element's size are one.
const SAME: f64 = 1e-3;

/// Elements whose normals have at least this cosine belong to one smooth surface: edges of up to 25 degrees.
const SMOOTH: f64 = 0.9;

/// Middles look at each other from this share of an element's size above it.
const ABOVE: f64 = 1e-3;

/// Irradiance at each corner, W/m²; of triangles the last is not used.
pub fn corner_irradiance(elements: &[Element], index: &RayIndex, irradiance: &[Rgb]) -> Vec<[Rgb; 4]> {
    let corners = elements.iter().enumerate().flat_map(|(number, element)| {
        element.corners.as_slice().iter().map(move |corner| GeomWithData::new(corner.to_array(), number))
    });
    let tree = RTree::bulk_load(corners.collect());
    let of_element = |(number, element): (usize, &Element)| {
        let size = element.area.sqrt();
        let is_buried = |number: usize| irradiance[number] == [0.0; 3];
        let joins = |other: usize| {
            let sees = || is_buried(number) || index.sees(lifted(element), lifted(&elements[other]));
            let is_alike = || elements[other].normal.dot(element.normal) >= SMOOTH;
            !is_buried(other) && (other == number || is_alike() && sees())
        };
        let known: Vec<Option<Rgb>> = element
            .corners
            .as_slice()
            .iter()
            .map(|corner| {
                let around = tree.locate_within_distance(corner.to_array(), (SAME * size).powi(2));
                mean(
                    around
                        .map(|found| found.data)
                        .filter(|&other| joins(other))
                        .map(|other| irradiance[other]),
                )
            })
            .collect();
        let elsewhere = mean(known.iter().copied().flatten()).unwrap_or_default();
        std::array::from_fn(|corner| known.get(corner).copied().flatten().unwrap_or(elsewhere))
    };
    elements.par_iter().enumerate().map(of_element).collect()
}

fn lifted(element: &Element) -> glam::DVec3 {
    element.centroid + element.normal * (ABOVE * element.area.sqrt())
}

/// The mean of some values, if there are any.
fn mean(values: impl Iterator<Item = Rgb>) -> Option<Rgb> {
    let (mut sum, mut count) = ([0.0; 3], 0.0);
    for value in values {
        (0..3).for_each(|c| sum[c] += value[c]);
        count += 1.0;
    }
    (count > 0.0).then(|| sum.map(|sum| sum / count))
}
