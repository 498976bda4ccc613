//! A sender polygon as seen from one receiver.

use super::directions::Span;
use crate::geometry::aabb::Aabb;
use crate::geometry::polygon::Polygon;
use crate::geometry::tolerance::IN_PLANE;
use glam::DVec3;

/// The view of a sender from one receiver, shared by all meshes.
#[derive(Debug)]
pub struct SeenPolygon {
    /// Corners relative to the receiver's point, above its horizon, counter-clockwise from the front.
    pub corners: Polygon,
    /// Box around its directions.
    pub span: Span,
    /// The face it lies in.
    pub(super) face: u32,
    /// Unit normal of its front.
    pub(super) normal: DVec3,
    /// Largest distance of a corner.
    pub(super) reach: f64,
}

impl SeenPolygon {
    /// The convex polygon on `corners`, a piece of `face`. Its front, towards the unit vector `normal`, must face the receiver.
    pub fn new(corners: Polygon, normal: DVec3, face: u32) -> Self {
        let span = Span::over(corners.iter().map(|p| p.normalize().as_vec3a()));
        let reach = corners.iter().map(|p| p.length_squared()).fold(0.0, f64::max).sqrt();
        Self { span, corners, normal, face, reach }
    }

    /// Height of a point over the plane.
    pub(super) fn height(&self, p: DVec3) -> f64 {
        self.normal.dot(p - self.corners[0])
    }

    /// Smallest and largest height in a box around `centre`.
    pub(super) fn heights_of_box(&self, centre: DVec3, half: DVec3) -> (f64, f64) {
        let (height, spread) = (self.height(centre), self.normal.abs().dot(half));
        (height - spread, height + spread)
    }

    /// Whether its box meets another, relative to the receiver's point.
    pub(super) fn meets_box(&self, Aabb { low, high }: Aabb) -> bool {
        let below = |axis: usize| self.corners.iter().all(|p| p[axis] < low[axis]);
        let above = |axis: usize| self.corners.iter().all(|p| p[axis] > high[axis]);
        !(0..3).any(|axis| below(axis) || above(axis))
    }

    /// Unit normals, inwards, of the planes through the receiver's point and one edge each. Edges seen as a point, such
    /// as between corners that differ by rounding only, have no plane.
    pub(super) fn sides(&self) -> Polygon {
        let count = self.corners.len();
        let side = |i: usize| {
            let (a, b) = (self.corners[i], self.corners[(i + 1) % count]);
            let normal = -a.cross(b - a);
            let (length2, slack) = (normal.length_squared(), IN_PLANE * a.length_squared());
            (length2 > slack * slack).then(|| normal / length2.sqrt())
        };
        (0..count).filter_map(side).collect()
    }
}

/// A direction in the inside of a convex polygon.
pub(super) fn middle(corners: &[DVec3]) -> DVec3 {
    corners.iter().sum::<DVec3>().normalize()
}
