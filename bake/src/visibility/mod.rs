//! Who may stand between two places: a bounding-volume hierarchy over faces, and rays for pictures and cross-checks.
//!
//! obvhs computes in f32, so boxes are padded outwards and a candidate is only ever a candidate: exact clipping in
//! f64 decides. No type of obvhs leaves this module.

pub mod rays;

use equilux_formats::Face;
use glam::{DVec3, Vec3A};
use obvhs::aabb::Aabb;
use obvhs::bvh2::{Bvh2, builder::build_bvh2};
use obvhs::{Boundable, BvhBuildParams};
use std::time::Duration;

/// Finds the faces that a region may touch.
pub struct FaceIndex {
    bvh: Option<Bvh2>,
    centre: DVec3,
    padding: f32,
}

impl FaceIndex {
    /// An index over `faces`; what it returns are positions in that slice.
    pub fn new(faces: &[Face]) -> Self {
        let (centre, padding) = frame(faces.iter().flat_map(|face| face.corners.iter().copied()));
        let boxes: Vec<Box3> =
            faces.iter().map(|face| Box3(bounds(&face.corners, centre, padding))).collect();
        Self { bvh: build(&boxes), centre, padding }
    }

    /// Append to `found` every face whose box touches the box around `region`, by rising index.
    pub fn candidates(&self, region: impl Iterator<Item = DVec3>, found: &mut Vec<u32>) {
        let Some(bvh) = &self.bvh else { return };
        let region: Vec<DVec3> = region.collect();
        bvh.aabb_traverse(bounds(&region, self.centre, self.padding), |bvh, node| {
            let node = &bvh.nodes[node as usize];
            let range = node.first_index as usize..(node.first_index + node.prim_count) as usize;
            found.extend_from_slice(&bvh.primitive_indices[range]);
            true
        });
        found.sort_unstable();
    }
}

struct Box3(Aabb);

impl Boundable for Box3 {
    fn aabb(&self) -> Aabb {
        self.0
    }
}

fn build(boxes: &[Box3]) -> Option<Bvh2> {
    let mut time = Duration::ZERO;
    (!boxes.is_empty()).then(|| build_bvh2(boxes, BvhBuildParams::medium_build(), &mut time))
}

/// The centre of all points, and the padding that covers the rounding of their f32 images around it: four units in
/// the last place of the largest coordinate.
fn frame(points: impl Iterator<Item = DVec3> + Clone) -> (DVec3, f32) {
    let (low, high) = points.fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(l, h), p| (l.min(p), h.max(p)));
    if low.x > high.x {
        return (DVec3::ZERO, 0.0);
    }
    ((low + high) / 2.0, ((high - low).max_element() * 4.0) as f32 * f32::EPSILON)
}

fn bounds(points: &[DVec3], centre: DVec3, padding: f32) -> Aabb {
    let local: Vec<Vec3A> = points.iter().map(|&p| (p - centre).as_vec3a()).collect();
    let around = Aabb::from_points(&local);
    Aabb::new(around.min - padding, around.max + padding)
}
