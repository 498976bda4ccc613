//! Finds the face of a scene in which a point lies.

use equilux_bake::world::World;
use equilux_formats::{Face, FaceId};
use glam::DVec3;

/// The faces of a world.
#[derive(Debug)]
pub struct Faces {
    faces: Vec<Face>,
    /// Largest coordinate, metres, to which rounding is proportional.
    size: f64,
}

/// The faces that lie in one plane.
#[derive(Debug)]
pub struct CoplanarFaces<'a> {
    faces: Vec<(FaceId, &'a Face)>,
}

/// Maximum difference of normals, and maximum distance of points from a plane as a share of the scene's size, for
/// lying in the plane: a few units in the last place of glTF's f32 coordinates.
const COPLANAR_TOLERANCE: f64 = 1e-6;

/// Minimum cosine of the angle between a surface and the face it may belong to.
const MIN_NORMAL_COSINE: f64 = 0.5;

impl Faces {
    /// The current faces of a world.
    pub fn of(world: &World) -> Self {
        let size = world.faces.iter().flat_map(|f| &f.corners).map(|p| p.abs().max_element());
        Self { faces: world.faces.clone(), size: size.fold(0.0, f64::max) }
    }

    /// The plane of one face, with that face alone.
    pub fn plane_of(&self, face: FaceId) -> CoplanarFaces<'_> {
        CoplanarFaces { faces: vec![(face, &self.faces[face.index()])] }
    }

    /// The faces in the plane through `point` with this normal or its opposite. If rounded corners leave none, the
    /// nearest face alone: a small face far from the origin may be tilted against the large one that it was joined
    /// to.
    pub fn in_plane(&self, point: DVec3, normal: DVec3) -> CoplanarFaces<'_> {
        let lies = |face: &Face| {
            face.normal.cross(normal).length() <= COPLANAR_TOLERANCE
                && (face.corners[0] - point).dot(normal).abs() <= COPLANAR_TOLERANCE * self.size
        };
        let all = || self.faces.iter().enumerate().map(|(n, face)| (FaceId::from_index(n), face));
        let faces: Vec<_> = all().filter(|(_, face)| lies(face)).collect();
        if !faces.is_empty() {
            return CoplanarFaces { faces };
        }
        let distance = |face: &Face| face.normal.dot(point - face.corners[0]).abs().max(outside(face, point));
        let alike = all().filter(|(_, face)| face.normal.dot(normal).abs() > MIN_NORMAL_COSINE);
        let nearest = alike.min_by(|(_, a), (_, b)| distance(a).total_cmp(&distance(b)));
        CoplanarFaces { faces: nearest.into_iter().collect() }
    }
}

impl CoplanarFaces<'_> {
    /// The face that contains the point, or whose edge is nearest to it; none if there is no face in the plane.
    pub fn face_at(&self, point: DVec3) -> Option<FaceId> {
        let nearest =
            self.faces.iter().min_by(|(_, a), (_, b)| outside(a, point).total_cmp(&outside(b, point)));
        nearest.map(|(face, _)| *face)
    }
}

/// The maximum distance of a point in a face's plane beyond the face's edges, metres; negative inside.
fn outside(face: &Face, point: DVec3) -> f64 {
    let corners = &face.corners;
    let beyond = |i: usize| {
        let (a, b) = (corners[i], corners[(i + 1) % corners.len()]);
        (b - a).cross(face.normal).normalize_or_zero().dot(point - a)
    };
    (0..corners.len()).map(beyond).fold(f64::NEG_INFINITY, f64::max)
}
