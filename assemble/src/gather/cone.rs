//! The cone of a spot: how much of a spot's intensity goes in a direction, and into a convex polygon. KHR_lights_punctual:
//! I(θ)/I = clamp(cos θ · s + o, 0, 1)², s = 1/(cos inner − cos outer), o = −s cos outer.

use crate::gather::piece::{cells, centre};
use equilux_bake::geometry::polygon::{Clipped, Polygon, clip};
use equilux_bake::geometry::solid_angle::solid_angle;
use glam::DVec3;
use std::f64::consts::TAU;

/// The cone of a spot, as KHR_lights_punctual has it.
#[derive(Debug, Clone)]
pub struct Cone {
    direction: DVec3,
    /// Slope and offset of the falloff in the cosine.
    scale: f64,
    offset: f64,
    /// Normals of planes through the light that touch the outer cone, pointing inwards.
    around: [DVec3; PLANES],
}

/// The cosines of a spot's cones are taken to differ by at least this, against division by zero: with equal angles the edge
/// is hard.
const SHARP: f64 = 1e-9;

/// Planes around the outer cone.
const PLANES: usize = 8;

/// What the planes leave of a polygon is cut this often along each side.
const CUTS: usize = 4;

/// Cells over which the falloff changes by more than this are cut again,
const STEEP: f64 = 0.1;

/// so many times: at a hard edge the light of a polygon is off by about a thousandth then.
const AGAIN: usize = 2;

impl Cone {
    /// A cone around `direction`, a unit vector, with these half angles, radians; `inner` is at most `outer`.
    pub fn new(direction: DVec3, inner: f64, outer: f64) -> Self {
        let scale = 1.0 / (inner.cos() - outer.cos()).max(SHARP);
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
        self.over_cells(&within, normal, AGAIN)
    }

    fn over_cells(&self, polygon: &[DVec3], normal: DVec3, again: usize) -> f64 {
        let of = |cell: Polygon| {
            let middle = self.falloff(centre(&cell, normal).0);
            let corners = || cell.iter().map(|&corner| self.falloff(corner));
            match again {
                1.. if corners().any(|corner| (corner - middle).abs() > STEEP) => {
                    self.over_cells(&cell, normal, again - 1)
                }
                // Simpson's rule: exact for what is quadratic over a parallelogram.
                _ => {
                    solid_angle(&cell).abs() * (2.0 * middle + corners().sum::<f64>() / cell.len() as f64)
                        / 3.0
                }
            }
        };
        cells(polygon, CUTS).into_iter().map(of).sum()
    }
}
