//! How often a closed shell goes around a point: a ray from the point along the x axis leaves through a face that many
//! times more often than it enters through one. It is the winding number of [`super::shells::winding_number`], in whole
//! numbers and from the faces on the ray alone, if each edge lies between two faces.

use glam::DVec3;

/// Faces that the ray leaves through, minus those that it enters through. `faces`: corners of convex faces of a shell, at
/// least of all that meet the ray, in any order; fronts are outside. `point` lies on none of them.
///
/// Seen along the axis, a face goes around the point once or not at all. An edge counts for both of its faces from the
/// same two numbers, so a ray at an edge crosses one of them (Sunday 2001 for the rule).
pub(crate) fn crossings<'a>(point: DVec3, faces: impl Iterator<Item = &'a [DVec3]>) -> i32 {
    let is_ahead = |corners: &[DVec3]| {
        let normal: DVec3 =
            corners.windows(2).skip(1).map(|edge| (edge[0] - corners[0]).cross(edge[1] - corners[0])).sum();
        normal.dot(corners[0] - point) * normal.x > 0.0
    };
    let around = |corners: &[DVec3]| -> i32 {
        let edge = |i: usize| crossing(point, corners[i], corners[(i + 1) % corners.len()]);
        (0..corners.len()).map(edge).sum()
    };
    faces
        .map(|corners| (around(corners), corners))
        .filter(|&(n, c)| n != 0 && is_ahead(c))
        .map(|(n, _)| n)
        .sum()
}

/// What an edge adds to the number of turns around the point in the plane of y and z.
fn crossing(point: DVec3, from: DVec3, to: DVec3) -> i32 {
    let upwards = from.z <= point.z;
    if upwards == (to.z <= point.z) {
        return 0;
    }
    let (low, high) = if upwards { (from, to) } else { (to, from) };
    let left = (high.y - low.y) * (point.z - low.z) - (point.y - low.y) * (high.z - low.z);
    match (left > 0.0, upwards) {
        (false, _) => 0,
        (true, true) => 1,
        (true, false) => -1,
    }
}

#[cfg(test)]
mod tests {
    use super::super::shells::winding_number;
    use super::*;
    use crate::rays::shapes::{globe, point};
    use proptest::prelude::*;

    proptest! {
        /// Two globes, one of them somewhere in the other or beside it.
        #[test]
        fn crossings_are_the_winding_number(inner in globe(), outer in globe(), moved in point(), at in point()) {
            let corners = |face: &equilux_formats::Face, by: DVec3| {
                face.corners.iter().rev().map(|&corner| corner + by).collect::<Vec<_>>()
            };
            let faces: Vec<Vec<DVec3>> = inner
                .iter()
                .map(|face| corners(face, moved))
                .chain(outer.iter().map(|face| corners(face, DVec3::ZERO)))
                .collect();
            let all = || faces.iter().map(Vec::as_slice);
            let winding = winding_number(at, all());
            prop_assume!((winding - winding.round()).abs() < 1e-6);
            prop_assert_eq!(f64::from(crossings(at, all())), winding.round());
        }
    }
}
