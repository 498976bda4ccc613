//! A sample of rays from a scene's elements: element → direction → first hit.
//!
//! Elements are chosen by area and directions by the cosine, so that each ray represents the same share of the light
//! that a uniformly bright scene would exchange.

use crate::placed_parts::PlacedParts;
use equilux_bake::rays::{Hit, RayIndex};
use equilux_formats::Element;
use glam::{DVec2, DVec3};
use std::f64::consts::{PI, TAU};

/// Number of rays: a share of 1 % is 82 of them, with a standard deviation of 9.
const RAYS: usize = 8192;

/// The generalised golden ratio of three dimensions, whose powers make an evenly spread sequence (Roberts 2018).
const SEQUENCE_STEPS: [f64; 3] = [0.819_172_513_396_164_4, 0.671_043_606_703_789_2, 0.549_700_477_901_970_3];

/// The hits of a sample of rays, and an index for more rays.
pub(super) struct RaySample<'a> {
    /// The first hit of each ray; none if it leaves the scene.
    pub hits: Vec<Option<Hit>>,
    /// All elements.
    pub index: RayIndex<'a>,
}

impl<'a> RaySample<'a> {
    /// A sample of rays from the elements of a scene.
    pub(super) fn of(placed: &'a PlacedParts) -> Self {
        let elements = &placed.world.elements;
        let index = RayIndex::new(elements);
        let mut upto = Vec::with_capacity(elements.len());
        let total = elements.iter().fold(0.0, |sum, element| {
            upto.push(sum + element.area);
            sum + element.area
        });
        let ray = |number: usize| {
            let [u, v, w] = SEQUENCE_STEPS.map(|step| (0.5 + step * number as f64).fract());
            let chosen = upto.partition_point(|&upto| upto <= u * total).min(elements.len() - 1);
            let (start, direction) = leaving(&elements[chosen], DVec2::new(v, w));
            index.first_hit(start, direction)
        };
        let hits = if elements.is_empty() { vec![] } else { (1..=RAYS).map(ray).collect() };
        Self { hits, index }
    }

    /// Whether no ray left the scene.
    pub(super) fn is_closed(&self) -> bool {
        self.hits.iter().all(Option::is_some)
    }

    /// Whether some ray met the black back of a surface.
    pub(super) fn shows_backs(&self) -> bool {
        self.hits.iter().flatten().any(|hit| !hit.front)
    }
}

/// A ray from just above the centroid of an element, from two numbers in 0..1.
fn leaving(element: &Element, at: DVec2) -> (DVec3, DVec3) {
    let (u, v) = element.normal.any_orthonormal_pair();
    let (sin, cos) = (TAU * at.x).sin_cos();
    let direction = (u * cos + v * sin) * at.y.sqrt() + element.normal * (1.0 - at.y).sqrt();
    (element.centroid + element.normal * (1e-9 * (element.area / PI).sqrt()), direction)
}
