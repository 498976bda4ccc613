//! Contacts of sides along their edges, and the contacts across which light is smooth.
//!
//! Input: sides in one coordinate system. Output: pairs of sides with the segment of edge that they share. Edges need
//! not have equal ends: a long edge may meet several short ones.

use super::side::SurfaceSide;
use equilux_bake::geometry::aabb::Aabb;
use equilux_bake::geometry::tolerance::FLATNESS;
use glam::DVec3;
use std::f64::consts::FRAC_PI_6;

/// Sides that meet at an angle of at most this belong to one curved surface, radians: for example, a cylinder with
/// twelve sides.
pub const MAX_SMOOTH_ANGLE: f64 = FRAC_PI_6 * (1.0 + 1e-9);

/// Two sides with a common segment of edge.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Contact {
    /// The indices of the sides, the lower one first.
    pub sides: [usize; 2],
    /// The ends of the segment, metres.
    pub ends: [DVec3; 2],
    /// Whether the sides traverse the segment in opposite directions, as neighbours with the same orientation do.
    opposed: bool,
}

/// The contacts of neighbours with the same orientation, at any angle.
pub fn opposed_contacts(sides: &[SurfaceSide]) -> impl Iterator<Item = Contact> {
    contacts(sides, tolerance(sides)).into_iter().filter(|contact| contact.opposed)
}

/// The contacts across which light changes smoothly: the sides' normals differ by at most [`MAX_SMOOTH_ANGLE`], and no third
/// side stands on the edge and separates the light on them.
pub fn smooth_contacts(sides: &[SurfaceSide]) -> Vec<Contact> {
    let tolerance = tolerance(sides);
    let all = contacts(sides, tolerance);
    let mut of_side: Vec<Vec<&Contact>> = vec![Vec::new(); sides.len()];
    for contact in &all {
        contact.sides.iter().for_each(|&side| of_side[side].push(contact));
    }
    let smooth = |contact: &&Contact| {
        let [a, b] = contact.sides.map(|side| sides[side].normal);
        contact.opposed && a.dot(b) >= MAX_SMOOTH_ANGLE.cos() && {
            let front = (a + b).normalize();
            !of_side[contact.sides[0]].iter().any(|other| separates(contact, other, sides, front, tolerance))
        }
    };
    all.iter().filter(smooth).copied().collect()
}

/// Tolerance of lengths: several times the rounding of coordinates.
fn tolerance(sides: &[SurfaceSide]) -> f64 {
    let corners = sides.iter().flat_map(|side| side.corners.as_slice());
    4.0 * FLATNESS * corners.map(|p| p.abs().max_element()).fold(0.0, f64::max)
}

/// Whether the third side of contact `other` stands on `contact` and rises in front of its sides, towards `front`.
fn separates(
    contact: &Contact,
    other: &Contact,
    sides: &[SurfaceSide],
    front: DVec3,
    tolerance: f64,
) -> bool {
    let Some(third) = other.sides.into_iter().find(|side| !contact.sides.contains(side)) else {
        return false;
    };
    let foot = contact.ends[0];
    let rises = sides[third].corners.as_slice().iter().any(|&p| (p - foot).dot(front) > tolerance);
    rises && shared(contact.ends, other.ends, tolerance).is_some()
}

/// An edge of a side, and its extent along the sweep axis.
struct SideEdge {
    side: usize,
    ends: [DVec3; 2],
    reach: [f64; 2],
}

/// All contacts longer than the tolerance, by a sweep along the longest axis, in an order that does not depend on
/// threads.
fn contacts(sides: &[SurfaceSide], tolerance: f64) -> Vec<Contact> {
    let axis = longest_axis(sides);
    let mut edges: Vec<SideEdge> =
        sides.iter().enumerate().flat_map(|(number, side)| edges_of(number, side, axis)).collect();
    edges.sort_by(|a, b| a.reach[0].total_cmp(&b.reach[0]).then(a.side.cmp(&b.side)));
    let (mut found, mut open): (Vec<Contact>, Vec<&SideEdge>) = (Vec::new(), Vec::new());
    for edge in &edges {
        open.retain(|other| other.reach[1] >= edge.reach[0] - tolerance);
        found.extend(open.iter().filter_map(|other| contact(other, edge, tolerance)));
        open.push(edge);
    }
    found.sort_by_key(|contact| contact.sides);
    found
}

fn longest_axis(sides: &[SurfaceSide]) -> usize {
    let extent = Aabb::around(sides.iter().flat_map(|side| side.corners.as_slice())).size();
    (0..3).max_by(|&a, &b| extent[a].total_cmp(&extent[b])).unwrap_or(0)
}

fn edges_of(number: usize, side: &SurfaceSide, axis: usize) -> impl Iterator<Item = SideEdge> {
    let corners = side.corners.as_slice();
    (0..corners.len()).map(move |i| {
        let ends = [corners[i], corners[(i + 1) % corners.len()]];
        let [from, to] = ends.map(|p| p[axis]);
        SideEdge { side: number, ends, reach: [from.min(to), from.max(to)] }
    })
}

fn contact(a: &SideEdge, b: &SideEdge, tolerance: f64) -> Option<Contact> {
    if a.side == b.side {
        return None;
    }
    let ends = shared(a.ends, b.ends, tolerance)?;
    let opposed = (a.ends[1] - a.ends[0]).dot(b.ends[1] - b.ends[0]) < 0.0;
    Some(Contact { sides: [a.side.min(b.side), a.side.max(b.side)], ends, opposed })
}

/// The segment of `a` that also lies on `b`, if it is longer than the tolerance.
fn shared(a: [DVec3; 2], b: [DVec3; 2], tolerance: f64) -> Option<[DVec3; 2]> {
    // Bounding boxes exclude nearly all pairs.
    let apart = |p: [DVec3; 2], q: [DVec3; 2]| (p[0].min(p[1]) - q[0].max(q[1])).max_element() > tolerance;
    if apart(a, b) || apart(b, a) {
        return None;
    }
    let length = (a[1] - a[0]).length();
    let along = (a[1] - a[0]) / length;
    let [from, to] = b.map(|p| (p - a[0]).dot(along));
    let (low, high) = (from.min(to).max(0.0), from.max(to).min(length));
    let on_b = |t: f64| b[0] + (b[1] - b[0]) * ((t - from) / (to - from));
    let near = |t: f64| (a[0] + along * t - on_b(t)).length() <= tolerance;
    (high - low > 4.0 * tolerance && near(low) && near(high)).then(|| [low, high].map(|t| a[0] + along * t))
}

#[cfg(test)]
mod tests {
    use super::*;
    use equilux_formats::{Corners, MaterialId, Surface};
    use glam::dvec3;

    fn side(corners: [[f64; 3]; 4]) -> SurfaceSide {
        SurfaceSide::of(&Surface::new(Corners::quad(corners.map(DVec3::from_array)), MaterialId(0)))
    }

    /// The square over `[x, x + 1]` × `[y, y + 1]` at z = 0, facing up.
    fn tile(x: f64, y: f64) -> SurfaceSide {
        side([[x, y, 0.0], [x + 1.0, y, 0.0], [x + 1.0, y + 1.0, 0.0], [x, y + 1.0, 0.0]])
    }

    #[test]
    fn a_long_edge_touches_each_short_one_and_corners_touch_nothing() {
        let sides = [tile(0.0, 0.0), tile(1.0, 0.25), tile(1.0, -0.75), tile(-1.0, 1.0)];
        let found: Vec<_> = smooth_contacts(&sides).iter().map(|c| (c.sides, c.ends)).collect();
        let expected = [
            ([0, 1], [dvec3(1.0, 0.25, 0.0), dvec3(1.0, 1.0, 0.0)]),
            ([0, 2], [dvec3(1.0, 0.0, 0.0), dvec3(1.0, 0.25, 0.0)]),
            ([1, 2], [dvec3(2.0, 0.25, 0.0), dvec3(1.0, 0.25, 0.0)]),
        ];
        let same = |(sides, ends): &([usize; 2], [DVec3; 2])| {
            expected.iter().any(|(s, e)| s == sides && (e == ends || [e[1], e[0]] == *ends))
        };
        assert!(found.len() == 3 && found.iter().all(same), "found {found:?}, expected {expected:?}");
    }

    /// The light on the two sides of a partition is unrelated; a kerb below the floor separates nothing.
    #[test]
    fn sides_above_an_edge_separate_light_and_sides_below_do_not() {
        let wall = |z: f64| side([[1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [1.0, 1.0, z], [1.0, 0.0, z]]);
        for (z, smooth) in [(0.5, false), (-0.5, true)] {
            let found = smooth_contacts(&[tile(0.0, 0.0), tile(1.0, 0.0), wall(z)]);
            assert_eq!(!found.is_empty(), smooth, "a side up to z = {z}: {found:?}");
        }
    }
}
