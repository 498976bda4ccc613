//! Faces as triangles and parallelograms, eight at a time: which of them a ray may meet, in f32.
//!
//! A plate is origin o, edges u and v, and the points o + a u + b v with a, b ≥ 0 and a, b ≤ 1 (a parallelogram) or
//! a + b ≤ 1 (a triangle). What rounding leaves open is let through, and decided in f64.

use super::lanes::{LANES, Lanes, Mask, max, min};
use super::wide_tree::Ray32;
use crate::geometry::aabb::Aabb;
use glam::{DAffine3, DVec3};

/// A triangle or parallelogram of a face.
#[derive(Debug, Clone, Copy)]
pub struct Plate {
    /// The face.
    pub face: u32,
    /// One corner.
    pub corner: DVec3,
    /// The edges that leave it.
    pub edges: [DVec3; 2],
    /// Whether it is a parallelogram, not a triangle.
    pub is_parallelogram: bool,
}

impl Plate {
    /// The box around it.
    pub fn bounds(&self) -> Aabb {
        let (corner, [u, v]) = (self.corner, self.edges);
        let last = if self.is_parallelogram { corner + u + v } else { corner };
        Aabb::around([corner, corner + u, corner + v, last])
    }

    /// The plate moved.
    pub fn moved(&self, by: &DAffine3) -> Self {
        let edges = self.edges.map(|edge| by.transform_vector3(edge));
        Self { corner: by.transform_point3(self.corner), edges, ..*self }
    }
}

/// Eight plates.
#[derive(Debug, Clone)]
pub struct Plates {
    normal: [Lanes; 3],
    offset: Lanes,
    /// a = first · p − first_offset, and b likewise.
    first: [Lanes; 3],
    first_offset: Lanes,
    second: [Lanes; 3],
    second_offset: Lanes,
    /// 1 for a triangle, whose third edge is 1 - a - b; 0 for a parallelogram, with 1 - a and 1 - b.
    diagonal: Lanes,
    /// How far these may be off for each unit of length that the hit is.
    slack: Lanes,
    /// The face of each.
    pub faces: [u32; LANES],
    is_present: [bool; LANES],
}

impl Plates {
    /// Up to eight plates, relative to `centre`.
    pub fn new(plates: &[Plate], centre: DVec3) -> Self {
        let none = Lanes::all(0.0);
        let mut these = Self {
            normal: [none; 3],
            offset: none,
            first: [none; 3],
            first_offset: none,
            second: [none; 3],
            second_offset: none,
            diagonal: none,
            slack: none,
            faces: [u32::MAX; LANES],
            is_present: [false; LANES],
        };
        for (lane, plate) in plates.iter().enumerate() {
            these.set(lane, plate, plate.corner - centre);
        }
        these
    }

    fn set(&mut self, lane: usize, plate: &Plate, corner: DVec3) {
        let [u, v] = plate.edges;
        let normal = u.cross(v);
        // The dual basis: first · u = 1, first · v = 0, and the other way round.
        let first = v.cross(normal) / normal.length_squared();
        let second = normal.cross(u) / normal.length_squared();
        let normal = normal.normalize();
        for axis in 0..3 {
            self.normal[axis].0[lane] = normal[axis] as f32;
            self.first[axis].0[lane] = first[axis] as f32;
            self.second[axis].0[lane] = second[axis] as f32;
        }
        self.offset.0[lane] = normal.dot(corner) as f32;
        self.first_offset.0[lane] = first.dot(corner) as f32;
        self.second_offset.0[lane] = second.dot(corner) as f32;
        self.diagonal.0[lane] = if plate.is_parallelogram { 0.0 } else { 1.0 };
        let steepest = first.length().max(second.length()).max((first + second).length());
        self.slack.0[lane] = steepest as f32;
        self.faces[lane] = plate.face;
        self.is_present[lane] = true;
    }

    /// The plates that the ray may meet before it has gone `most`, and those that it meets for certain wherever it meets their
    /// plane.
    #[inline(always)]
    pub fn met(&self, ray: &Ray32, most: f32) -> (Mask, Mask) {
        let ([ox, oy, oz], [dx, dy, dz]) = (ray.origin.to_array(), ray.direction.to_array());
        let (mut met, mut within) = ([false; LANES], [false; LANES]);
        for k in 0..LANES {
            let [nx, ny, nz] = [self.normal[0].0[k], self.normal[1].0[k], self.normal[2].0[k]];
            let approach = nx * dx + ny * dy + nz * dz;
            let inverse = 1.0 / approach;
            let t = (self.offset.0[k] - (nx * ox + ny * oy + nz * oz)) * inverse;
            // A plane seen at a grazing angle is met at a place that is much less certain.
            let off = ray.rounding * (1.0 + inverse.abs());
            let (px, py, pz) = (ox + t * dx, oy + t * dy, oz + t * dz);
            let [ax, ay, az] = [self.first[0].0[k], self.first[1].0[k], self.first[2].0[k]];
            let [bx, by, bz] = [self.second[0].0[k], self.second[1].0[k], self.second[2].0[k]];
            let a = ax * px + ay * py + az * pz - self.first_offset.0[k];
            let b = bx * px + by * py + bz * pz - self.second_offset.0[k];
            let (low, high) = (min(a, b), max(a, b));
            let inside = min(low, 1.0 - high - self.diagonal.0[k] * low);
            let slack = self.slack.0[k] * off;
            // Written so that a ray along the plane, for which t is no number, is let through.
            let misses = (t < -off) | (t > most + off) | (inside < -slack);
            met[k] = !misses & self.is_present[k];
            within[k] = inside > slack;
        }
        (Mask::of(met), Mask::of(within))
    }
}
