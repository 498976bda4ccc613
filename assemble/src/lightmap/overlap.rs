//! Tests whether convex polygons overlap in projection, by separating axes. Touching does not count as overlapping.

use equilux_bake::geometry::tolerance::FLATNESS;
use equilux_formats::Corners;
use glam::{DVec2, DVec3};

/// Whether any two of `polygons` overlap by more than rounding when projected along `direction` (unit).
pub fn any_overlap(polygons: impl Iterator<Item = Corners>, direction: DVec3) -> bool {
    let (u, v) = direction.any_orthonormal_pair();
    let seen = |corners: Corners| -> ProjectedPolygon {
        ProjectedPolygon::new(corners.as_slice().iter().map(|p| DVec2::new(p.dot(u), p.dot(v))).collect())
    };
    let mut seen: Vec<ProjectedPolygon> = polygons.map(seen).collect();
    let reach = seen.iter().map(|s| s.low.abs().max(s.high.abs()).max_element()).fold(0.0, f64::max);
    let tolerance = 8.0 * FLATNESS * reach;
    seen.sort_by(|a, b| a.low.x.total_cmp(&b.low.x));
    (0..seen.len()).any(|i| {
        let near = seen[i + 1..].iter().take_while(|other| other.low.x < seen[i].high.x - tolerance);
        near.into_iter().any(|other| overlap(&seen[i], other, tolerance))
    })
}

/// A polygon in projection, and its bounding box.
struct ProjectedPolygon {
    corners: Vec<DVec2>,
    low: DVec2,
    high: DVec2,
}

impl ProjectedPolygon {
    fn new(corners: Vec<DVec2>) -> Self {
        let low = corners.iter().copied().fold(DVec2::INFINITY, DVec2::min);
        let high = corners.iter().copied().fold(DVec2::NEG_INFINITY, DVec2::max);
        Self { corners, low, high }
    }
}

fn overlap(a: &ProjectedPolygon, b: &ProjectedPolygon, tolerance: f64) -> bool {
    let boxes_apart = a.low.y >= b.high.y - tolerance || b.low.y >= a.high.y - tolerance;
    !boxes_apart && !edge_between(a, b, tolerance) && !edge_between(b, a, tolerance)
}

/// Whether some edge of `a` has all of `b` on its outer side.
fn edge_between(a: &ProjectedPolygon, b: &ProjectedPolygon, tolerance: f64) -> bool {
    (0..a.corners.len()).any(|i| {
        let (from, to) = (a.corners[i], a.corners[(i + 1) % a.corners.len()]);
        let Some(outward) = (from - to).perp().try_normalize() else { return false };
        b.corners.iter().all(|&p| (p - from).dot(outward) >= -tolerance)
    })
}
