//! Which face of a scene a point of its surface lies in.

use equilux_bake::world::World;
use equilux_formats::{Face, FaceId};
use glam::DVec3;

/// The faces of a world.
#[derive(Debug)]
pub struct Faces {
    faces: Vec<Face>,
    /// Largest coordinate, metres: roundings are of its size.
    size: f64,
}

/// The faces that lie in one plane.
#[derive(Debug)]
pub struct CoplanarFaces<'a> {
    faces: Vec<(FaceId, &'a Face)>,
}

/// Normals that differ by less, and points that are nearer to a plane than this share of the scene, are in it: a few units
/// in the last place of the f32 numbers that glTF stores.
const NEAR: f64 = 1e-6;

/// Cosine of the angle up to which a face may be the one that a surface belongs to.
const ALIKE: f64 = 0.5;

impl Faces {
    /// The faces that are in a world now.
    pub fn of(world: &World) -> Self {
        let size = world.faces.iter().flat_map(|f| &f.corners).map(|p| p.abs().max_element());
        Self { faces: world.faces.clone(), size: size.fold(0.0, f64::max) }
    }

    /// The plane of one face, with that face alone.
    pub fn plane_of(&self, face: FaceId) -> CoplanarFaces<'_> {
        CoplanarFaces { faces: vec![(face, &self.faces[face.index()])] }
    }

    /// The faces in the plane through `point` with this normal or its opposite; the nearest face alone where corners that are
    /// rounded leave none: a small face far from the origin is turned away from the large one that it was joined to.
    pub fn in_plane(&self, point: DVec3, normal: DVec3) -> CoplanarFaces<'_> {
        let lies = |face: &Face| {
            face.normal.cross(normal).length() <= NEAR
                && (face.corners[0] - point).dot(normal).abs() <= NEAR * self.size
        };
        let all = || self.faces.iter().enumerate().map(|(n, face)| (FaceId::from_index(n), face));
        let faces: Vec<_> = all().filter(|(_, face)| lies(face)).collect();
        if !faces.is_empty() {
            return CoplanarFaces { faces };
        }
        let distance = |face: &Face| face.normal.dot(point - face.corners[0]).abs().max(outside(face, point));
        let alike = all().filter(|(_, face)| face.normal.dot(normal).abs() > ALIKE);
        let nearest = alike.min_by(|(_, a), (_, b)| distance(a).total_cmp(&distance(b)));
        CoplanarFaces { faces: nearest.into_iter().collect() }
    }
}

impl CoplanarFaces<'_> {
    /// The face that holds the point, or whose edge is nearest to it; none if there is no face in the plane.
    pub fn face_at(&self, point: DVec3) -> Option<FaceId> {
        let nearest =
            self.faces.iter().min_by(|(_, a), (_, b)| outside(a, point).total_cmp(&outside(b, point)));
        nearest.map(|(face, _)| *face)
    }
}

/// How far a point in a face's plane lies outside of it at most, along the normals of its edges; negative inside.
fn outside(face: &Face, point: DVec3) -> f64 {
    let corners = &face.corners;
    let beyond = |i: usize| {
        let (a, b) = (corners[i], corners[(i + 1) % corners.len()]);
        (b - a).cross(face.normal).normalize_or_zero().dot(point - a)
    };
    (0..corners.len()).map(beyond).fold(f64::NEG_INFINITY, f64::max)
}
