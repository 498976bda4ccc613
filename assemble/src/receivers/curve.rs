//! The smooth surface that a flat side of a mesh stands for. Input: the side's corners, and their normals. Output: for a point of
//! the side, the normal of that surface, and how far in front of the side it lies.
//!
//! With barycentric coordinates b_i of the point p and unit normals n_i of the corners v_i,
//!
//! ```text
//! n ∝ Σ b_i n_i,   p' = p + Σ b_i max(0, (v_i − p)·n_i) n_i
//! ```
//!
//! (Phong 1975; Hanika 2021, "Hacking the shadow terminator", Ray Tracing Gems II, ch. 4). A convex side thus does not shadow
//! itself: what lies before the plane through p' across n lies before the side. A concave one keeps its place.

use equilux_bake::rays::hemisphere::SurfacePoint;
use glam::{DVec3, dvec3};

/// A smooth surface over a triangle or a quad.
#[derive(Debug, Clone)]
pub struct Curve {
    corners: Vec<DVec3>,
    normals: Vec<DVec3>,
}

impl Curve {
    /// The surface over these three or four corners with their normals.
    pub fn new(corners: &[DVec3], normals: &[DVec3]) -> Self {
        let normals = normals.iter().map(|normal| normal.normalize_or_zero());
        Self { corners: corners.to_vec(), normals: normals.take(corners.len()).collect() }
    }

    /// The surface at a point of the side. A quad is two triangles that meet in the diagonal of its first corner.
    pub fn at(&self, point: DVec3) -> SurfacePoint {
        let triangles = (2..self.corners.len()).map(|last| [0, last - 1, last]);
        let weighted = triangles.map(|triangle| (triangle, self.weights(triangle, point)));
        // The triangle that contains the point, or is least far from it.
        let inside = |weights: &DVec3| weights.min_element();
        let best = weighted.max_by(|a, b| inside(&a.1).total_cmp(&inside(&b.1)));
        let (triangle, weights) = best.expect("a side has three corners");
        let (mut normal, mut lift) = (DVec3::ZERO, DVec3::ZERO);
        let weights = weights.max(DVec3::ZERO);
        let weights = weights / weights.element_sum();
        for (corner, weight) in triangle.into_iter().zip(weights.to_array()) {
            let (v, n) = (self.corners[corner], self.normals[corner]);
            normal += n * weight;
            lift += n * (weight * (v - point).dot(n).max(0.0));
        }
        SurfacePoint { normal: normal.normalize_or_zero(), lift }
    }

    /// The barycentric coordinates of a point, of which some are negative outside of the triangle.
    fn weights(&self, [a, b, c]: [usize; 3], point: DVec3) -> DVec3 {
        let [a, b, c] = [a, b, c].map(|corner| self.corners[corner]);
        let across = (b - a).cross(c - a);
        let share = |u: DVec3, v: DVec3| u.cross(v).dot(across) / across.length_squared();
        let (second, third) = (share(point - a, c - a), share(b - a, point - a));
        dvec3(1.0 - second - third, second, third)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        /// On a side with corners on a ball and its normals, the normals point from the middle, and the surface lies outside of the ball by at most
        /// as much as the flat side lies inside: tangent planes at the corners are twice as far from the side as the ball is, up to the
        /// square of that. And no corner lies before any of the surface's own tangent planes.
        #[test]
        fn a_side_of_a_ball_stands_for_the_ball(
            turns in prop::collection::vec(-0.1..0.1_f64, 6), s in 0.0..1.0_f64, t in 0.0..1.0_f64,
        ) {
            let corners = [[0.2, 0.0], [-0.1, 0.17], [-0.1, -0.17]].iter().zip(turns.chunks(2));
            let corners: Vec<DVec3> = corners.map(|(at, by)| dvec3(at[0] + by[0], at[1] + by[1], 1.0).normalize()).collect();
            let (s, t) = if s + t > 1.0 { (1.0 - s, 1.0 - t) } else { (s, t) };
            let point = corners[0] * (1.0 - s - t) + corners[1] * s + corners[2] * t;
            let SurfacePoint { normal, lift } = Curve::new(&corners, &corners).at(point);
            let on_ball = point + lift;
            prop_assert!(normal.dot(point.normalize()) >= 1.0 - 1e-12, "{normal} at {point}");
            let inside = 1.0 - point.length();
            let outside = on_ball.length() - 1.0;
            prop_assert!((-inside * inside - 1e-12..=1.1 * inside + 1e-12).contains(&outside), "{outside} outside of a side {inside} inside");
            prop_assert!(corners.iter().all(|corner| (*corner - on_ball).dot(normal) <= 1e-12));
        }
    }

    /// Seen from inside, the ball lies behind its sides.
    #[test]
    fn a_hollow_is_not_lifted() {
        let corners =
            [dvec3(0.2, 0.0, 1.0), dvec3(-0.1, 0.17, 1.0), dvec3(-0.1, -0.17, 1.0)].map(DVec3::normalize);
        let inwards = corners.map(|corner| -corner);
        let found = Curve::new(&corners, &inwards).at(corners.iter().sum::<DVec3>() / 3.0);
        assert_eq!(found.lift, DVec3::ZERO);
    }
}
