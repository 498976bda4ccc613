//! The pyramids that occluders hide from each receiver of a cluster, lane by lane: planes through the receiver's point
//! and the edges of the silhouette. Senders are classified against these planes.

use crate::form_factor::wide::{LANES, Lane, Vectors, squared, towards, vectorised};
use crate::geometry::outline::{NO_SIDE, Outline};
use crate::geometry::tolerance::IN_PLANE;
use glam::DVec3;
use std::ops::Range;

/// The planes of one edge, one a lane: unit normal inwards, and an offset added to distances. An edge that is no
/// silhouette for a lane has a zero normal and the offset ∞, which restricts nothing.
pub type EdgePlanes = [Lane; 4];

/// The pyramids of many occluders.
#[derive(Default)]
pub struct Pyramids {
    planes: Vec<EdgePlanes>,
    /// The end of the planes of each chunk of receivers, for one occluder after the other.
    ends: Vec<usize>,
}

/// The pyramids of one occluder.
#[derive(Debug, Clone, Copy)]
pub struct OccluderPyramids {
    first: u32,
}

/// The position of a sender relative to an occluder's pyramids.
pub struct Lies {
    /// At most zero for lanes from which nothing is hidden.
    pub aside: Lane,
    /// The planes that cut the sender, one bit each; the last bit stands for all planes from there on. A sender that is
    /// cut by none and is not aside is hidden.
    pub cuts: [u64; LANES],
}

/// The bit that represents all planes from this one on.
pub const LAST_BIT: usize = 63;

impl Pyramids {
    /// Removes all pyramids.
    pub fn clear(&mut self) {
        self.planes.clear();
        self.ends.clear();
    }

    /// Adds the pyramids that an occluder hides from the points of all lanes.
    pub fn add(&mut self, outline: &Outline, lanes: &[Vectors]) -> OccluderPyramids {
        let first = self.ends.len();
        vectorised(
            #[inline(always)]
            || {
                for points in lanes {
                    add_planes(outline, points, &mut self.planes);
                    self.ends.push(self.planes.len());
                }
            },
        );
        OccluderPyramids { first: first as u32 }
    }

    /// The planes of one chunk of receivers.
    pub fn planes(&self, pyramids: OccluderPyramids, chunk: usize) -> &[EdgePlanes] {
        &self.planes[self.range(pyramids.first as usize + chunk)]
    }

    fn range(&self, chunk: usize) -> Range<usize> {
        let start = if chunk == 0 { 0 } else { self.ends[chunk - 1] };
        start..self.ends[chunk]
    }
}

/// The normal of one lane's plane.
pub fn normal_of(planes: &EdgePlanes, lane: usize) -> DVec3 {
    DVec3::new(planes[0][lane], planes[1][lane], planes[2][lane])
}

#[inline(always)]
fn add_planes(outline: &Outline, points: &Vectors, planes: &mut Vec<EdgePlanes>) {
    let mut looks: smallvec::SmallVec<[Lane; 16]> = smallvec::SmallVec::new();
    for side in &outline.sides {
        let to = towards(side.point, points);
        let length2 = squared(&to);
        let mut look = [0.0; LANES];
        for lane in 0..LANES {
            let along =
                side.normal.x * to[0][lane] + side.normal.y * to[1][lane] + side.normal.z * to[2][lane];
            let reach = length2[lane].sqrt() + outline.size;
            look[lane] = if along < -IN_PLANE * reach { 1.0 } else { 0.0 };
        }
        looks.push(look);
    }
    let never = [0.0; LANES];
    for edge in &outline.edges {
        let left = &looks[edge.left as usize];
        let right = if edge.right == NO_SIDE { &never } else { &looks[edge.right as usize] };
        if left == right {
            continue;
        }
        let (a, ab) = (towards(edge.ends[0], points), edge.ends[1] - edge.ends[0]);
        let far2 = squared(&a);
        let mut plane = [[0.0; LANES]; 4];
        for lane in 0..LANES {
            let sign = right[lane] - left[lane];
            let x = (a[1][lane] * ab.z - a[2][lane] * ab.y) * sign;
            let y = (a[2][lane] * ab.x - a[0][lane] * ab.z) * sign;
            let z = (a[0][lane] * ab.y - a[1][lane] * ab.x) * sign;
            // Edges that are seen end-on, are no silhouette, or join corners that differ by rounding only, have no length here.
            let length = (x * x + y * y + z * z).sqrt();
            let none = length <= IN_PLANE * far2[lane];
            let inverse = if none { 0.0 } else { 1.0 / length };
            plane[0][lane] = x * inverse;
            plane[1][lane] = y * inverse;
            plane[2][lane] = z * inverse;
            plane[3][lane] = if none { f64::INFINITY } else { 0.0 };
        }
        planes.push(plane);
    }
    if outline.thin {
        // Seen edge-on, neither side faces the receiver, and nothing is hidden.
        let mut plane = [[0.0; LANES]; 4];
        for lane in 0..LANES {
            let edge_on = looks[0][lane] == looks[1][lane];
            plane[3][lane] = if edge_on { f64::NEG_INFINITY } else { f64::INFINITY };
        }
        if plane[3].contains(&f64::NEG_INFINITY) {
            planes.push(plane);
        }
    }
}

/// The position of the sender with these corners (relative to each point) relative to the planes of one occluder.
/// Corners within `slack` of a plane count as in it, so that a sender that shares an edge with the silhouette is hidden
/// either entirely or not at all.
#[inline(always)]
pub fn lies(planes: &[EdgePlanes], corners: &[Vectors], slack: &Lane) -> Lies {
    let mut lies = Lies { aside: [f64::INFINITY; LANES], cuts: [0; LANES] };
    for (number, [x, y, z, offset]) in planes.iter().enumerate() {
        let (mut low, mut high) = ([f64::INFINITY; LANES], [f64::NEG_INFINITY; LANES]);
        for corner in corners {
            for lane in 0..LANES {
                let distance = x[lane].mul_add(
                    corner[0][lane],
                    y[lane].mul_add(corner[1][lane], z[lane].mul_add(corner[2][lane], offset[lane])),
                );
                low[lane] = if distance < low[lane] { distance } else { low[lane] };
                high[lane] = if distance > high[lane] { distance } else { high[lane] };
            }
        }
        let bit = 1u64 << number.min(LAST_BIT);
        for lane in 0..LANES {
            let above = high[lane] - slack[lane];
            lies.aside[lane] = if above < lies.aside[lane] { above } else { lies.aside[lane] };
            lies.cuts[lane] |= if low[lane] < -slack[lane] { bit } else { 0 };
        }
    }
    lies
}
