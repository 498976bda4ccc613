//! Irradiance at the corners of elements, averaged over the elements that share them. Input: elements and the
//! irradiance of each. Output: one value for each corner.
//!
//! A corner gets the mean of the adjacent elements that lie in about the same plane and whose centroids see each
//! other, so that light does not leak below a wall that stands on a floor. An element whose centroid is covered, by a
//! crate on the floor or by a rug, has only the light of the gap below the cover; its visible part gets the light of
//! the adjacent elements, and it contributes none.

use equilux_bake::rays::RayIndex;
use equilux_formats::{Element, Rgb};
use glam::DVec3;
use rayon::prelude::*;
use rstar::RTree;
use rstar::primitives::GeomWithData;

/// Maximum distance of corners that count as one, as a share of an element's size.
const SAME_CORNER_SHARE: f64 = 1e-3;

/// Minimum cosine between the normals of elements of one smooth surface: edges of up to 25 degrees.
const MIN_SMOOTH_COSINE: f64 = 0.9;

/// Height above an element at which visibility between centres is tested, as a share of the element's size.
const TEST_HEIGHT_SHARE: f64 = 1e-3;

/// Irradiance below this share of the brightest is rounding.
const DARK_SHARE: f64 = 1e-9;

/// Maximum distance of geometry above a covered centroid, as a share of the element's size.
const MAX_COVER_DISTANCE_SHARE: f64 = 0.1;

/// Irradiance at each corner, W/m²; the last value of a triangle is unused.
pub fn corner_irradiance(elements: &[Element], index: &RayIndex, irradiance: &[Rgb]) -> Vec<[Rgb; 4]> {
    let corners = elements.iter().enumerate().flat_map(|(number, element)| {
        element.corners.as_slice().iter().map(move |corner| GeomWithData::new(corner.to_array(), number))
    });
    let tree = RTree::bulk_load(corners.collect());
    let brightest = irradiance.iter().flatten().copied().fold(0.0, f64::max);
    let is_covered = |(element, h): (&Element, &Rgb)| {
        let above = index.first_hit(lifted(element), element.normal);
        let is_dark = h.iter().all(|&h| h <= DARK_SHARE * brightest);
        above.is_some_and(|hit| {
            hit.distance < MAX_COVER_DISTANCE_SHARE * element.area.sqrt() || is_dark && !hit.front
        })
    };
    let covered: Vec<bool> = elements.par_iter().zip(irradiance).map(is_covered).collect();
    let of_element = |(number, element): (usize, &Element)| {
        let size = element.area.sqrt();
        let joins = |other: usize| {
            let sees = || covered[number] || index.sees(lifted(element), lifted(&elements[other]));
            let is_alike = || elements[other].normal.dot(element.normal) >= MIN_SMOOTH_COSINE;
            !covered[other] && (other == number || is_alike() && sees())
        };
        let known: Vec<Option<Rgb>> = element
            .corners
            .as_slice()
            .iter()
            .map(|corner| {
                let around =
                    tree.locate_within_distance(corner.to_array(), (SAME_CORNER_SHARE * size).powi(2));
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

fn lifted(element: &Element) -> DVec3 {
    element.centroid + element.normal * (TEST_HEIGHT_SHARE * element.area.sqrt())
}

/// The mean of some values, if there are any.
fn mean(values: impl Iterator<Item = Rgb>) -> Option<Rgb> {
    let (mut sum, mut count) = (Rgb::BLACK, 0.0);
    for value in values {
        (0..3).for_each(|c| sum[c] += value[c]);
        count += 1.0;
    }
    (count > 0.0).then(|| sum / count)
}

#[cfg(test)]
mod tests {
    use super::*;
    use equilux_formats::{Corners, FaceId, MaterialId};

    /// A square at `corner` that spans `u` and `v`, its front towards u × v.
    fn square(corner: DVec3, u: DVec3, v: DVec3) -> Element {
        Element::new(
            Corners::quad([corner, corner + u, corner + u + v, corner + v]),
            MaterialId(0),
            FaceId(0),
        )
    }

    /// A floor of four by two squares that look up; its light rises from 1 by 1 a square along x.
    fn floor() -> (Vec<Element>, Vec<Rgb>) {
        let squares = (0..8).map(|k| (f64::from(k % 4), f64::from(k / 4)));
        let at = |(x, z)| square(DVec3::new(x, 0.0, z), DVec3::Z, DVec3::X);
        (squares.clone().map(at).collect(), squares.map(|(x, _)| Rgb::splat(x + 1.0)).collect())
    }

    /// The values of the corners at x = 2 of the squares on either side of it.
    fn at_two(elements: &[Element], irradiance: &[Rgb]) -> [Vec<f64>; 2] {
        let values = corner_irradiance(elements, &RayIndex::new(elements), irradiance);
        let of = |element: usize| {
            let corners = elements[element].corners.as_slice().iter().zip(values[element]);
            corners.filter(|(corner, _)| corner.x == 2.0).map(|(_, value)| value[0]).collect()
        };
        [of(1), of(2)]
    }

    #[test]
    fn neighbours_meet_half_way() {
        let (elements, irradiance) = floor();
        assert_eq!(at_two(&elements, &irradiance), [vec![2.5, 2.5], vec![2.5, 2.5]]);
    }

    #[test]
    fn light_does_not_leak_below_a_wall() {
        let (mut elements, mut irradiance) = floor();
        elements.push(square(DVec3::new(2.0, 0.0, 0.0), 2.0 * DVec3::Y, 2.0 * DVec3::Z));
        irradiance.push(Rgb([7.0; 3]));
        assert_eq!(at_two(&elements, &irradiance), [vec![2.0, 2.0], vec![3.0, 3.0]]);
    }

    #[test]
    fn what_lies_below_a_rug_takes_the_light_around_and_gives_none() {
        let (mut elements, mut irradiance) = floor();
        // A rug that looks up, a centimetre above the centroid of the second square, which is dim.
        elements.push(square(DVec3::new(1.1, 0.01, 0.1), 0.8 * DVec3::Z, 0.8 * DVec3::X));
        irradiance.push(Rgb::splat(7.0));
        irradiance[1] = Rgb::splat(0.1);
        let [below, beside] = at_two(&elements, &irradiance);
        let (meeting, alone) = ((3.0 + 2.0 + 3.0) / 3.0, 3.0);
        assert_eq!((below, beside), (vec![meeting, alone], vec![alone, meeting]));
    }

    #[test]
    fn a_corner_below_a_crate_takes_the_light_around_and_gives_none() {
        let (mut elements, mut irradiance) = floor();
        // The lid of a crate over the second square, seen from below by its back.
        elements.push(square(DVec3::new(1.1, 0.5, 0.1), 0.8 * DVec3::Z, 0.8 * DVec3::X));
        irradiance.push(Rgb([7.0; 3]));
        irradiance[1] = Rgb::BLACK;
        let [below, beside] = at_two(&elements, &irradiance);
        // Where four squares meet three are lit, by 3, 2 and 3; where two meet one is. Corners go round each square.
        let (meeting, alone) = ((3.0 + 2.0 + 3.0) / 3.0, 3.0);
        assert_eq!((below, beside), (vec![meeting, alone], vec![alone, meeting]));
    }
}
