//! First hits of rays, for pictures and as an independent check of the exact visibility.
//!
//! The intersection is computed in f64 against the element's own polygon; a point on a shared edge belongs to both
//! elements, so no ray slips through.

use crate::geometry::box_tree::{Box3, bounds, build, frame};
use crate::geometry::tolerance::{SAME_HIT, TRIPLE_PRODUCT};
use equilux_formats::Element;
use glam::DVec3;
use obvhs::bvh2::Bvh2;
use obvhs::ray::{Ray, RayHit};
use std::fmt;

/// An index for finding the first hit of a ray.
pub struct RayIndex<'a> {
    elements: &'a [Element],
    bvh: Option<Bvh2>,
    centre: DVec3,
}

/// A hit of a ray.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hit {
    /// Index of the element.
    pub element: usize,
    /// Distance in units of the ray's direction.
    pub distance: f64,
    /// Whether the ray meets the front.
    pub front: bool,
}

impl fmt::Debug for RayIndex<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("RayIndex").field("elements", &self.elements.len()).finish_non_exhaustive()
    }
}

impl<'a> RayIndex<'a> {
    /// An index over `elements`.
    pub fn new(elements: &'a [Element]) -> Self {
        let corners = elements.iter().flat_map(|e| e.corners.as_slice().iter().copied());
        let (centre, padding) = frame(corners);
        // Rays may start a few extents away, and the rounding of slab tests grows with their length.
        let padding = 8.0 * padding;
        let boxes: Vec<Box3> =
            elements.iter().map(|e| Box3(bounds(e.corners.as_slice(), centre, padding))).collect();
        Self { elements, bvh: build(&boxes), centre }
    }

    /// The nearest hit beyond distance 0 along `direction` from `origin`. Of two elements back to back, the one that
    /// faces the origin is hit.
    pub fn first_hit(&self, origin: DVec3, direction: DVec3) -> Option<Hit> {
        self.nearest(origin, direction, |_| true)
    }

    /// The nearest hit beyond distance 0 on a front; backs are transparent.
    pub fn first_front(&self, origin: DVec3, direction: DVec3) -> Option<Hit> {
        self.nearest(origin, direction, |hit| hit.front)
    }

    fn nearest(&self, origin: DVec3, direction: DVec3, counts: impl Fn(&Hit) -> bool) -> Option<Hit> {
        let bvh = self.bvh.as_ref()?;
        let mut nearest: Option<Hit> = None;
        let ray = Ray::new_inf((origin - self.centre).as_vec3a(), direction.as_vec3a());
        // The index sees only boxes in f32; the hit itself is found and kept here in f64.
        bvh.ray_traverse(ray, &mut RayHit::none(), |_, slot| {
            let element = bvh.primitive_indices[slot] as usize;
            if let Some(hit) = self.intersect(element, origin, direction)
                && counts(&hit)
                && nearest.is_none_or(|n| closer(&hit, &n))
            {
                nearest = Some(hit);
                return (hit.distance * (1.0 + 1e-5)) as f32;
            }
            f32::INFINITY
        });
        nearest
    }

    /// All hits beyond distance 0 along `direction` from `origin`, in no order.
    pub fn all_hits(&self, origin: DVec3, direction: DVec3) -> Vec<Hit> {
        let hits = std::cell::RefCell::new(Vec::new());
        self.nearest(origin, direction, |hit| {
            hits.borrow_mut().push(*hit);
            false
        });
        hits.into_inner()
    }

    /// Whether nothing stands between two points, the ends themselves (within 1e-9 of the distance) left out.
    pub fn sees(&self, from: DVec3, to: DVec3) -> bool {
        let direction = to - from;
        let start = from + direction * SAME_HIT;
        self.first_hit(start, direction).is_none_or(|hit| hit.distance >= 1.0 - 2.0 * SAME_HIT)
    }

    fn intersect(&self, index: usize, origin: DVec3, direction: DVec3) -> Option<Hit> {
        let element = &self.elements[index];
        let approach = element.normal.dot(direction);
        let corners = element.corners.as_slice();
        let distance = element.normal.dot(corners[0] - origin) / approach;
        if !(distance > 0.0 && distance.is_finite()) {
            return None;
        }
        let inside = (0..corners.len()).all(|i| {
            let (a, b) = (corners[i] - origin, corners[(i + 1) % corners.len()] - origin);
            // Both elements that share the edge get the same number, but the edges that meet in a corner each round
            // their own way: without this much tolerance a ray at the corner might pass outside of all of them.
            let rounding = TRIPLE_PRODUCT * a.length() * b.length() * direction.length();
            a.cross(b).dot(direction) * approach.signum() >= -rounding
        });
        inside.then_some(Hit { element: index, distance, front: approach < 0.0 })
    }
}

fn closer(hit: &Hit, than: &Hit) -> bool {
    let tie = (hit.distance - than.distance).abs() <= SAME_HIT * than.distance;
    if tie { hit.front && !than.front } else { hit.distance < than.distance }
}

#[cfg(test)]
mod tests {
    use super::*;
    use equilux_formats::{Corners, FaceId, MaterialId};
    use proptest::prelude::*;

    /// A quad at `corner` that spans `u` and `v`, its front towards u × v.
    fn quad(corner: DVec3, u: DVec3, v: DVec3) -> Element {
        let corners = Corners::quad([corner, corner + u, corner + u + v, corner + v]);
        Element::new(corners, MaterialId(0), FaceId(0))
    }

    /// The unit cube seen from inside, each side in 4 × 4 elements whose edges are shared bit for bit.
    fn room() -> Vec<Element> {
        let mut elements = vec![];
        for axis in 0..3 {
            let (u, v) = (DVec3::AXES[(axis + 1) % 3] / 4.0, DVec3::AXES[(axis + 2) % 3] / 4.0);
            for (i, j) in (0..16).map(|cell| (f64::from(cell % 4), f64::from(cell / 4))) {
                elements.push(quad(u * i + v * j, u, v));
                elements.push(quad(u * i + v * j + DVec3::AXES[axis], v, u));
            }
        }
        elements
    }

    fn point() -> impl Strategy<Value = DVec3> {
        (0.0..1.0, 0.0..1.0, 0.0..1.0).prop_map(|(x, y, z)| DVec3::new(x, y, z))
    }

    proptest! {
        #[test]
        fn the_first_hit_is_the_nearest_of_all(from in point(), to in point()) {
            let elements = room();
            let index = RayIndex::new(&elements);
            let (origin, direction) = (from * 5.0 - 2.0, to - (from * 5.0 - 2.0));
            let all = || (0..elements.len()).filter_map(|e| index.intersect(e, origin, direction));
            let nearest = all().map(|hit| hit.distance).reduce(f64::min);
            let nearest_front = all().filter(|hit| hit.front).map(|hit| hit.distance).reduce(f64::min);
            // The ray aims at the inside of a closed room, so it meets something, and a front at the latest as it leaves.
            prop_assert!(nearest_front.is_some());
            let found = |hit: Option<Hit>| hit.map(|hit| hit.distance);
            // Distances within 1e-9 of each other are ties.
            let same = |a: Option<f64>, b: Option<f64>| (a.unwrap() - b.unwrap()).abs() <= 1e-9 * b.unwrap();
            prop_assert!(same(found(index.first_hit(origin, direction)), nearest));
            prop_assert!(same(found(index.first_front(origin, direction)), nearest_front));
        }

        #[test]
        fn no_ray_slips_out_through_a_shared_edge(from in point(), element in 0usize..96, along in 0..4) {
            let elements = room();
            let corners = elements[element].corners;
            let (a, b) = (corners.as_slice()[0], corners.as_slice()[1]);
            let target = a + (b - a) * f64::from(along) / 3.0;
            prop_assert!(RayIndex::new(&elements).first_hit(from, target - from).is_some());
        }
    }

    #[test]
    fn a_front_hides_and_a_back_does_not_count_as_a_front() {
        let sheet = |z: f64| quad(DVec3::new(0.0, 0.0, z), DVec3::X, DVec3::Y);
        let elements = [sheet(0.0), sheet(1.0)];
        let index = RayIndex::new(&elements);
        let (low, high) = (DVec3::new(0.4, 0.3, -1.0), DVec3::new(0.4, 0.3, 2.0));
        let from_front = index.first_hit(high, DVec3::NEG_Z).unwrap();
        assert_eq!((from_front.element, from_front.distance, from_front.front), (1, 1.0, true));
        let from_behind = index.first_hit(low, DVec3::Z).unwrap();
        assert_eq!((from_behind.element, from_behind.distance, from_behind.front), (0, 1.0, false));
        assert_eq!(index.first_front(low, DVec3::Z), None);
        assert!(!index.sees(low, high));
        assert!(index.sees(DVec3::new(0.4, 0.3, 0.0), DVec3::new(0.4, 0.3, 1.0)), "the ends do not count");
    }
}
