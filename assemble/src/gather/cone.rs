//! The cone of a spot light: the share of its intensity in a direction, and its integral over a convex polygon.
//! KHR_lights_punctual: I(θ)/I = clamp(cos θ · s + o, 0, 1)², s = 1/(cos inner − cos outer), o = −s cos outer.

use crate::gather::surface_piece::{cells, centre};
use equilux_bake::geometry::polygon::{Clipped, Polygon, clip};
use equilux_bake::geometry::solid_angle::solid_angle;
use glam::DVec3;
use std::f64::consts::TAU;

/// The cone of a spot light, as KHR_lights_punctual defines it.
#[derive(Debug, Clone)]
pub struct Cone {
    direction: DVec3,
    /// Slope and offset of the falloff in the cosine.
    scale: f64,
    offset: f64,
    /// Normals of planes through the light that touch the outer cone, pointing inwards.
    around: [DVec3; PLANES],
}

/// Minimum difference between the cosines of the two cone angles, to avoid division by zero: with equal angles the
/// edge is hard.
const MIN_COSINE_DIFFERENCE: f64 = 1e-9;

/// Number of planes around the outer cone.
const PLANES: usize = 8;

/// Number of cells on each side into which a clipped polygon is divided.
const CELLS_PER_SIDE: usize = 4;

/// Cells over which the falloff changes by more than this are divided again.
const MAX_FALLOFF_CHANGE: f64 = 0.1;

/// Maximum number of repeated divisions: the error at a hard edge is then about a thousandth.
const MAX_DIVISIONS: usize = 2;

impl Cone {
    /// A cone around `direction`, a unit vector, with these half angles, radians; `inner` is at most `outer`.
    pub fn new(direction: DVec3, inner: f64, outer: f64) -> Self {
        let scale = 1.0 / (inner.cos() - outer.cos()).max(MIN_COSINE_DIFFERENCE);
        let (u, v) = direction.any_orthonormal_pair();
        let around = std::array::from_fn(|k| {
            let (sine, cosine) = (TAU * k as f64 / PLANES as f64).sin_cos();
            direction * outer.sin() - (u * cosine + v * sine) * outer.cos()
        });
        Self { direction, scale, offset: -outer.cos() * scale, around }
    }

    /// The share of the intensity in a direction, of any length.
    pub fn falloff(&self, to: DVec3) -> f64 {
        let share = self.direction.dot(to) / to.length() * self.scale + self.offset;
        share.clamp(0.0, 1.0).powi(2)
    }

    /// ∫ I(ω)/I dω over a convex polygon with this unit normal, seen from the light at the origin, sr.
    pub fn share(&self, polygon: &[DVec3], normal: DVec3) -> f64 {
        let mut within: Polygon = polygon.iter().copied().collect();
        for plane in self.around {
            match clip(&within, |p| plane.dot(p)) {
                Clipped::All => {}
                Clipped::None => return 0.0,
                Clipped::Piece(piece) => within = piece,
            }
        }
        self.over_cells(&within, normal, MAX_DIVISIONS)
    }

    fn over_cells(&self, polygon: &[DVec3], normal: DVec3, again: usize) -> f64 {
        let of = |cell: Polygon| {
            let middle = self.falloff(centre(&cell, normal).0);
            let corners = || cell.iter().map(|&corner| self.falloff(corner));
            match again {
                1.. if corners().any(|corner| (corner - middle).abs() > MAX_FALLOFF_CHANGE) => {
                    self.over_cells(&cell, normal, again - 1)
                }
                // Simpson's rule, exact for quadratic functions over a parallelogram.
                _ => {
                    solid_angle(&cell).abs() * (2.0 * middle + corners().sum::<f64>() / cell.len() as f64)
                        / 3.0
                }
            }
        };
        cells(polygon, CELLS_PER_SIDE).into_iter().map(of).sum()
    }
}
