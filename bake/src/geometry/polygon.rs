//! Convex polygons, and clipping them by a plane or by the pyramid that an occluder hides.
//!
//! All points are relative to the receiver's collocation point, so every plane of a pyramid passes through the
//! origin and is given by its normal alone.

use super::tolerance::{CUT_ROUNDING, IN_PLANE, STRAIGHT};
use equilux_formats::Corners;
use glam::{DVec2, DVec3};
use smallvec::SmallVec;

/// A planar convex polygon, corners in order. Up to ten corners are stored inline, more on the heap.
pub type Polygon = SmallVec<[DVec3; 10]>;

/// A polygon clipped by a plane.
#[derive(Debug)]
#[expect(clippy::large_enum_variant, reason = "short-lived; a box would cost an allocation a cut")]
pub enum Clipped {
    /// The whole polygon.
    All,
    /// Nothing, or no more than an edge or a corner.
    None,
    /// This piece of it.
    Piece(Polygon),
}

/// The distance of a point from a convex polygon.
pub fn distance(point: DVec3, corners: &[DVec3]) -> f64 {
    let triangles = corners.windows(2).skip(1).map(|edge| [corners[0], edge[0], edge[1]]);
    triangles.map(|triangle| triangle_distance(point, triangle)).fold(f64::INFINITY, f64::min)
}

fn triangle_distance(point: DVec3, [a, b, c]: [DVec3; 3]) -> f64 {
    let normal = (b - a).cross(c - a).normalize_or_zero();
    let within = [(a, b), (b, c), (c, a)].iter().all(|&(p, q)| normal.dot((q - p).cross(point - p)) >= 0.0);
    if within && normal != DVec3::ZERO {
        return normal.dot(point - a).abs();
    }
    let to_edge = |(p, q): (DVec3, DVec3)| {
        let along = ((point - p).dot(q - p) / (q - p).length_squared()).clamp(0.0, 1.0);
        (p + (q - p) * along - point).length()
    };
    [(a, b), (b, c), (c, a)].map(to_edge).into_iter().fold(f64::INFINITY, f64::min)
}

/// The area of a planar convex polygon, m².
pub fn area(polygon: &[DVec3]) -> f64 {
    let origin = polygon[0];
    let double: DVec3 = polygon.windows(2).skip(1).map(|e| (e[0] - origin).cross(e[1] - origin)).sum();
    double.length() / 2.0
}

/// The part of `polygon` where `distance` (an affine function of the point) is positive. Corners on the plane belong to
/// both sides, and a polygon that only touches the plane is not cut. Only signs decide, and a cut point lies between
/// the corners of its edge. A piece no higher than the rounding of its corners counts as an edge: [`Clipped::None`].
pub fn clip(polygon: &[DVec3], distance: impl Fn(DVec3) -> f64) -> Clipped {
    let distances: SmallVec<[f64; 12]> = polygon.iter().map(|&p| distance(p)).collect();
    if distances.iter().all(|&d| d >= 0.0) {
        return if distances.iter().any(|&d| d > 0.0) { Clipped::All } else { Clipped::None };
    }
    if distances.iter().all(|&d| d <= 0.0) {
        return Clipped::None;
    }
    let mut piece = Polygon::new();
    for (i, (&p, &dp)) in polygon.iter().zip(&distances).enumerate() {
        let next = if i + 1 == polygon.len() { 0 } else { i + 1 };
        let (q, dq) = (polygon[next], distances[next]);
        if dp >= 0.0 {
            piece.push(p);
        }
        if (dp > 0.0 && dq < 0.0) || (dp < 0.0 && dq > 0.0) {
            piece.push(p + (q - p) * (dp / (dp - dq)));
        }
    }
    if is_edge(&piece) { Clipped::None } else { Clipped::Piece(piece) }
}

/// The pieces of `polygon` on both sides of a plane: where `distance` is positive, and where it is negative. A polygon
/// in the plane is the first.
pub fn part(polygon: &[DVec3], distance: impl Fn(DVec3) -> f64) -> [Option<Polygon>; 2] {
    let side = |sign: f64| match clip(polygon, |p| sign * distance(p)) {
        Clipped::All => Some(Polygon::from_slice(polygon)),
        Clipped::None => None,
        Clipped::Piece(piece) => Some(piece),
    };
    match [side(1.0), side(-1.0)] {
        [None, None] => [Some(Polygon::from_slice(polygon)), None],
        sides => sides,
    }
}

/// Whether the height of a planar convex polygon over its longest edge is within the rounding of its corners.
fn is_edge(polygon: &[DVec3]) -> bool {
    let origin = polygon[0];
    let (mut double_area, mut longest2, mut reach2) = (DVec3::ZERO, 0.0_f64, 0.0_f64);
    let mut from = polygon[polygon.len() - 1];
    for &to in polygon {
        double_area += (from - origin).cross(to - origin);
        longest2 = longest2.max((to - from).length_squared());
        reach2 = reach2.max(to.length_squared());
        from = to;
    }
    double_area.length_squared() <= CUT_ROUNDING * CUT_ROUNDING * longest2 * reach2
}

/// Splits a planar convex polygon into quads, and a triangle where corners are left. Pieces no higher than the rounding
/// of their corners, such as the tip of a needle, are dropped, as by [`clip`].
pub(crate) fn quads_and_triangles(polygon: &[DVec3]) -> Vec<Corners> {
    let mut pieces = Vec::new();
    let mut next = 1;
    while next + 2 < polygon.len() {
        pieces.push(Corners::quad([polygon[0], polygon[next], polygon[next + 1], polygon[next + 2]]));
        next += 2;
    }
    if next + 1 < polygon.len() {
        pieces.push(Corners::triangle([polygon[0], polygon[next], polygon[next + 1]]));
    }
    pieces.retain(|piece| !is_edge(piece.as_slice()));
    pieces
}

/// The pyramid of directions that a convex occluder hides from the origin.
#[derive(Debug, Clone)]
pub struct Pyramid {
    /// Normals of the planes through the origin and one edge each, pointing inwards. If there are none, everything is hidden.
    planes: Polygon,
}

/// How much of a polygon a pyramid hides.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Hides {
    /// Nothing of it.
    Nothing,
    /// Possibly a piece of it.
    Part,
    /// All of it.
    All,
}

impl Pyramid {
    /// The pyramid over `occluder`, which must lie wholly in the open half space before the sender's plane and whose
    /// own plane must not contain the origin. An edge between two corners that differ by rounding only has no direction
    /// and adds no plane.
    pub fn over(occluder: &[DVec3], normal: DVec3) -> Self {
        // Seen from the origin the corners run counter-clockwise around the inside if the normal points away from it.
        let facing = if normal.dot(occluder[0]) > 0.0 { 1.0 } else { -1.0 };
        let planes = (0..occluder.len())
            .filter_map(|i| {
                let (a, b) = (occluder[i], occluder[(i + 1) % occluder.len()]);
                let plane = a.cross(b - a) * facing;
                let slack = IN_PLANE * a.length_squared();
                (plane.length_squared() > slack * slack).then_some(plane)
            })
            .collect();
        Self::between(planes)
    }

    /// The pyramid between planes through the origin. Normals point inwards and may have any length.
    pub fn between(planes: Polygon) -> Self {
        Self { planes: planes.into_iter().map(DVec3::normalize).collect() }
    }

    /// How much of `polygon` the pyramid hides. Corners within [`IN_PLANE`] of a side count as in it, so that a polygon
    /// that shares an edge with the silhouette is hidden either entirely or not at all.
    pub fn hides(&self, polygon: &[DVec3]) -> Hides {
        let reach = polygon.iter().map(|p| p.length_squared()).fold(0.0, f64::max).sqrt();
        let slack = IN_PLANE * reach;
        let mut all = true;
        for plane in &self.planes {
            let (low, high) = polygon.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), p| {
                let distance = plane.dot(*p);
                (low.min(distance), high.max(distance))
            });
            if high <= slack {
                return Hides::Nothing;
            }
            all &= low >= -slack;
        }
        if all { Hides::All } else { Hides::Part }
    }

    /// How many corners of `polygon` lie inside.
    pub fn corners_inside(&self, polygon: &[DVec3]) -> usize {
        polygon.iter().filter(|p| self.planes.iter().all(|plane| plane.dot(**p) >= 0.0)).count()
    }

    /// The piece of `polygon` inside, if there is one.
    pub fn intersect(&self, polygon: &[DVec3]) -> Option<Polygon> {
        let mut inside: Polygon = polygon.iter().copied().collect();
        for plane in &self.planes {
            match clip(&inside, |p| plane.dot(p)) {
                Clipped::All => {}
                Clipped::None => return None,
                Clipped::Piece(piece) => inside = piece,
            }
        }
        Some(inside)
    }

    /// Whether `polygon` lies wholly behind one of the planes, and therefore outside.
    pub fn misses(&self, polygon: &[DVec3]) -> bool {
        self.planes.iter().any(|plane| polygon.iter().all(|p| plane.dot(*p) <= 0.0))
    }

    /// Appends to `outside` the convex pieces of `polygon` that the pyramid does not hide.
    ///
    /// Each plane cuts off what lies behind it; the remainder is hidden.
    pub fn subtract_from(&self, polygon: Polygon, outside: &mut Vec<Polygon>) {
        if self.misses(&polygon) {
            outside.push(polygon);
            return;
        }
        let mut inside = polygon;
        for plane in &self.planes {
            match clip(&inside, |p| -plane.dot(p)) {
                Clipped::None => {}
                Clipped::All => {
                    outside.push(inside);
                    return;
                }
                Clipped::Piece(piece) => {
                    outside.push(piece);
                    match clip(&inside, |p| plane.dot(p)) {
                        Clipped::Piece(rest) => inside = rest,
                        Clipped::All => {}
                        Clipped::None => return,
                    }
                }
            }
        }
    }
}

/// The convex hull of points in a plane, counter-clockwise around `normal`, without corners that bend by rounding only
/// (Andrew 1979).
///
/// All corners are found by signs alone, because columns of a grid differ by rounding along one axis and a tolerance
/// would drop their ends. Then corners on the line between their neighbours are removed.
pub fn convex_hull(points: impl Iterator<Item = DVec3>, normal: DVec3) -> Polygon {
    let (u, v) = normal.any_orthonormal_pair();
    let mut sorted: SmallVec<[(DVec2, DVec3); 32]> =
        points.map(|p| (DVec2::new(p.dot(u), p.dot(v)), p)).collect();
    sorted.sort_by(|(a, _), (b, _)| a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y)));
    sorted.dedup_by_key(|(place, _)| *place);
    let half = |points: &mut dyn Iterator<Item = (DVec2, DVec3)>| {
        let mut chain: SmallVec<[(DVec2, DVec3); 16]> = SmallVec::new();
        for p in points {
            while chain.len() >= 2 && !turns_left(&chain[chain.len() - 2..], p, 0.0) {
                chain.pop();
            }
            chain.push(p);
        }
        chain.pop();
        chain
    };
    if sorted.len() == 1 {
        return Polygon::from_slice(&[sorted[0].1]);
    }
    let mut hull = half(&mut sorted.iter().copied());
    hull.extend(half(&mut sorted.iter().rev().copied()));
    let mut next = 0;
    while hull.len() > 2 && next < hull.len() {
        let count = hull.len();
        let corner = [hull[(next + count - 1) % count], hull[next]];
        if turns_left(&corner, hull[(next + 1) % count], STRAIGHT) {
            next += 1;
        } else {
            hull.remove(next);
            next = next.saturating_sub(1);
        }
    }
    hull.into_iter().map(|(_, p)| p).collect()
}

/// Whether the path through two points to a third turns left by more than this sine.
fn turns_left(way: &[(DVec2, DVec3)], to: (DVec2, DVec3), sine: f64) -> bool {
    let (ab, bc) = (way[1].0 - way[0].0, to.0 - way[1].0);
    ab.perp_dot(bc) > sine * ab.length() * bc.length()
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::dvec3;
    use proptest::prelude::*;

    proptest! {
        /// A plane through a triangle of any shape, near a corner or an edge of it or elsewhere: both pieces have an area, are
        /// on their side, and what is missing of the whole is rounding.
        #[test]
        fn both_sides_of_a_cut_have_an_area_or_are_none(
            corners in prop::array::uniform3(prop::array::uniform3(-8.0..8.0_f64)),
            flat in prop_oneof![Just(1.0), Just(1e-6), Just(1e-15)],
            (normal, corner) in (prop::array::uniform3(-1.0..1.0_f64), 0..3_usize),
            off in prop_oneof![Just(0.0), -1e-13..1e-13_f64, -3.0..3.0_f64],
        ) {
            let [a, b, mut c] = corners.map(DVec3::from_array);
            c = a.lerp(b, 0.3) + (c - a.lerp(b, 0.3)) * flat;
            let (triangle, normal) = ([a, b, c], DVec3::from_array(normal).normalize_or(DVec3::X));
            let height = |p: DVec3| normal.dot(p - triangle[corner]) - off;
            let area = |polygon: &[DVec3]| {
                let fan = polygon.windows(2).skip(1).map(|e| (e[0] - polygon[0]).cross(e[1] - polygon[0]));
                fan.sum::<DVec3>().length() / 2.0
            };
            let mut sum = 0.0;
            for sign in [1.0, -1.0] {
                match clip(&triangle, |p| sign * height(p)) {
                    Clipped::All => sum += area(&triangle),
                    Clipped::None => {}
                    Clipped::Piece(piece) => {
                        sum += area(&piece);
                        prop_assert!(area(&piece) > 0.0, "{piece:?}");
                        // Heights are rounded like the coordinates.
                        prop_assert!(piece.iter().all(|&p| sign * height(p) >= -1e-13), "{piece:?}");
                    }
                }
            }
            // Coordinates up to 14 m, edges up to 28 m: what an edge has for an area.
            let rounding = 14.0 * 28.0 * CUT_ROUNDING;
            prop_assert!((sum - area(&triangle)).abs() <= 2.0 * rounding, "{} of {}", sum, area(&triangle));
        }
    }

    #[test]
    fn a_corner_that_reaches_over_by_rounding_is_no_piece() {
        let square =
            [DVec3::ZERO, DVec3::X, dvec3(1.0, 1.0, 0.0), DVec3::Y].map(|p| p + dvec3(90.0, 0.0, 90.0));
        let beyond = clip(&square, |p| p.x - (91.0 - 1e-14));
        assert!(matches!(beyond, Clipped::None), "a strip of one step of f64: {beyond:?}");
        assert!(matches!(clip(&square, |p| p.x - (91.0 - 1e-12)), Clipped::Piece(_)), "a strip of seventy");
    }

    /// Columns of a grid differ by rounding; whichever point of one comes first, the hull has the four corners.
    #[test]
    fn the_hull_of_a_grid_that_was_rounded_is_its_four_corners() {
        for k in 1..50u32 {
            let at = |i: u32, j: u32| {
                let rounding = f64::from((i * 7 + j * 3 + k * 11) % 5) * f64::EPSILON;
                DVec3::new(1.0 + f64::from(i) * 0.05 + rounding, 0.0, 1.0 + f64::from(j) * 0.05 - rounding)
            };
            let points: Vec<DVec3> = (0..35).map(|n| at(n % 5, n / 5)).collect();
            let hull = convex_hull(points.into_iter(), DVec3::Y);
            let is_corner = |p: DVec3| hull.iter().any(|q| (p - q).length() < 1e-12);
            let all = [at(0, 0), at(4, 0), at(4, 6), at(0, 6)].into_iter().all(is_corner);
            assert!(all && hull.len() == 4, "grid {k}: {hull:?}");
        }
    }
}
