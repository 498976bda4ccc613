//! First hits of rays, for pictures and as an independent check of the exact visibility.
//!
//! The intersection is computed in f64 against the element's own polygon; a point on a shared edge belongs to both
//! elements, so no ray slips through.

use super::{Box3, bounds, build, frame};
use equilux_formats::Element;
use glam::DVec3;
use obvhs::bvh2::Bvh2;
use obvhs::ray::{Ray, RayHit};

/// Finds what a ray meets first.
pub struct RayIndex<'a> {
    elements: &'a [Element],
    bvh: Option<Bvh2>,
    centre: DVec3,
    /// f32 needs numbers near one: scene lengths are divided by this.
    scale: f64,
}

/// What a ray meets.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hit {
    /// Index of the element.
    pub element: usize,
    /// Distance in units of the ray's direction.
    pub distance: f64,
    /// Whether the ray meets the front.
    pub front: bool,
}

impl<'a> RayIndex<'a> {
    /// An index over `elements`.
    pub fn new(elements: &'a [Element]) -> Self {
        let corners = elements.iter().flat_map(|e| e.corners.as_slice().iter().copied());
        let (centre, padding) = frame(corners);
        let boxes: Vec<Box3> =
            elements.iter().map(|e| Box3(bounds(e.corners.as_slice(), centre, padding))).collect();
        let scale = (f64::from(padding) / (4.0 * f64::from(f32::EPSILON))).max(f64::MIN_POSITIVE);
        Self { elements, bvh: build(&boxes), centre, scale }
    }

    /// The nearest hit beyond distance 0 along `direction` from `origin`. Of two elements back to back the one that
    /// shows its front is met.
    pub fn first_hit(&self, origin: DVec3, direction: DVec3) -> Option<Hit> {
        let bvh = self.bvh.as_ref()?;
        let mut nearest: Option<Hit> = None;
        let ray = Ray::new_inf((origin - self.centre).as_vec3a(), direction.as_vec3a());
        // The index sees only boxes in f32; the hit itself is found and kept here in f64.
        bvh.ray_traverse(ray, &mut RayHit::none(), |_, slot| {
            let element = bvh.primitive_indices[slot] as usize;
            if let Some(hit) = self.intersect(element, origin, direction)
                && nearest.is_none_or(|n| closer(&hit, &n))
            {
                nearest = Some(hit);
                return (hit.distance * (1.0 + 1e-5)) as f32;
            }
            f32::INFINITY
        });
        nearest
    }

    /// Whether nothing stands between two points, the ends themselves (within 1e-9 of the distance) left out.
    pub fn sees(&self, from: DVec3, to: DVec3) -> bool {
        let direction = to - from;
        let start = from + direction * 1e-9;
        self.first_hit(start, direction).is_none_or(|hit| hit.distance >= 1.0 - 2e-9)
    }

    /// The largest extent of the indexed elements, metres.
    pub fn extent(&self) -> f64 {
        self.scale
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
            // The sign of this triple product is the same from both elements that share the edge.
            a.cross(b).dot(direction) * approach >= 0.0
        });
        inside.then_some(Hit { element: index, distance, front: approach < 0.0 })
    }
}

fn closer(hit: &Hit, than: &Hit) -> bool {
    let tie = (hit.distance - than.distance).abs() <= 1e-9 * than.distance;
    if tie { hit.front && !than.front } else { hit.distance < than.distance }
}
