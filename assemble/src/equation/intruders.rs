//! Intruders: other geometry inside a part's hull, which could occlude two points of the part from each other.
//!
//! The hull is bounded by pairs of parallel planes in thirteen directions (Klosowski et al. 1998, 26-DOP). It
//! contains the convex hull, so no intruder is missed; the cells of a bisection touch it only from outside.

use equilux_bake::geometry::polygon::{Clipped, clip};
use equilux_bake::geometry::tolerance::FLATNESS;
use equilux_formats::{Face, Geometry, Instance};
use glam::{DAffine3, DVec3, dvec3};

/// The instances with geometry inside the hull of `instance`.
pub fn intruders<'a>(
    instances: &[Instance],
    geometry: impl Fn(usize) -> &'a Geometry,
    instance: usize,
) -> Vec<usize> {
    let hull = Hull::around(geometry(instance));
    let inverse = instances[instance].placement.inverse();
    let intrudes = |other: usize| {
        let to_part = inverse * instances[other].placement;
        geometry(other).faces.iter().any(|face| hull.holds(face, to_part))
    };
    (0..instances.len()).filter(|&other| other != instance && intrudes(other)).collect()
}

/// A convex region around a part, in the part's coordinates.
#[derive(Debug)]
pub struct Hull {
    slabs: Vec<(DVec3, f64, f64)>,
}

impl Hull {
    /// The hull of a part's faces, shrunk by the tolerance of coplanar faces.
    pub fn around(geometry: &Geometry) -> Self {
        let corners = || geometry.faces.iter().flat_map(|face| &face.corners);
        let tolerance = FLATNESS * corners().map(|p| p.abs().max_element()).fold(0.0, f64::max);
        let slab = |direction: DVec3| {
            let along = corners().map(|p| p.dot(direction));
            let (low, high) =
                along.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), d| (l.min(d), h.max(d)));
            (direction, low + tolerance, high - tolerance)
        };
        Self { slabs: directions().map(slab).to_vec() }
    }

    /// Whether any part of `face`, transformed by `to_part` into the part's coordinates, lies inside.
    pub fn holds(&self, face: &Face, to_part: DAffine3) -> bool {
        let mut rest: Vec<DVec3> = face.corners.iter().map(|&p| to_part.transform_point3(p)).collect();
        for &(direction, low, high) in &self.slabs {
            for (sign, limit) in [(1.0, low), (-1.0, -high)] {
                match clip(&rest, |p| sign * p.dot(direction) - limit) {
                    Clipped::All => {}
                    Clipped::None => return false,
                    Clipped::Piece(piece) => rest = piece.to_vec(),
                }
            }
        }
        true
    }
}

/// Axes, face diagonals and space diagonals of a cube, unit length.
fn directions() -> [DVec3; 13] {
    [
        dvec3(1., 0., 0.),
        dvec3(0., 1., 0.),
        dvec3(0., 0., 1.),
        dvec3(1., 1., 0.),
        dvec3(1., -1., 0.),
        dvec3(1., 0., 1.),
        dvec3(1., 0., -1.),
        dvec3(0., 1., 1.),
        dvec3(0., 1., -1.),
        dvec3(1., 1., 1.),
        dvec3(1., 1., -1.),
        dvec3(1., -1., 1.),
        dvec3(-1., 1., 1.),
    ]
    .map(DVec3::normalize)
}
