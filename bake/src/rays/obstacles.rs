//! What may stand between two groups of places, found once for all shadow rays between them.
//!
//! With s(p) the distance of a place p from the plane of a plate, a segment from p to q with s(p) s(q) < 0 crosses that plane where
//! an affine coordinate a of the plate is
//!
//! ```text
//! a = (s(p) a(q) − s(q) a(p)) / (s(p) − s(q))
//! ```
//!
//! Where all of one group lie before the plane and all of the other behind it, the crossings of all segments between the two lie in
//! the convex hull of those between their corners, so corners decide whether a plate hides nothing or everything. Shafts between
//! two boxes: Haines & Wallace 1991, "Shaft culling for efficient ray-traced radiosity".

use super::hemisphere::Emitters;
use super::plates::Plate;
use super::scenery::{Scenery, moved};
use crate::geometry::aabb::Aabb;
use glam::DVec3;
use smallvec::SmallVec;

/// Segments that are tested at once, and corners of a group.
pub const LANES: usize = 8;

/// Rounding of a distance from a plane, relative to the largest coordinate: some ten operations.
const ROUNDING: f64 = 32.0 * f64::EPSILON;

/// How far beyond an edge still counts as on it, in edges.
const ON_EDGE: f64 = 1e-9;

/// Most leaves of trees of faces that are looked at. If there are more, each ray looks for itself.
const MOST_LEAVES: usize = 64;

/// Most plates that each ray is tested with one by one.
const MOST_PLATES: usize = 128;

/// Three coordinates, or three affine functions, of eight places.
pub type Eight = [[f64; LANES]; 3];

/// A convex body around some places on surfaces.
#[derive(Debug)]
pub struct Hull {
    corners: Eight,
    bounds: Aabb,
    /// A plane with its normal, n and n · p, before which all that is seen from there lies.
    plane: Option<(DVec3, f64)>,
}

impl Hull {
    /// A body around all places on these areas.
    pub fn around<'a>(areas: impl Iterator<Item = &'a Emitters> + Clone) -> Self {
        let bounds = Aabb::around(areas.clone().flat_map(Emitters::extremes));
        let mut normals = areas.clone().flat_map(Emitters::normals);
        let normal = normals.next().unwrap_or(DVec3::Z);
        let is_flat = normals.by_ref().all(|other| other == normal);
        let lowest = areas.clone().flat_map(Emitters::extremes).map(|p| normal.dot(p));
        let plane = is_flat.then(|| (normal, lowest.fold(f64::INFINITY, f64::min)));
        let own: SmallVec<[DVec3; 16]> = areas.flat_map(Emitters::extremes).take(LANES + 1).collect();
        let corners: SmallVec<[DVec3; 16]> =
            if own.len() <= LANES { own } else { bounds.corners().into_iter().collect() };
        let corner = |k: usize| corners[k.min(corners.len() - 1)];
        let corners = std::array::from_fn(|axis| std::array::from_fn(|k| corner(k)[axis]));
        Self { corners, bounds, plane }
    }

    /// The box in the scene around it and another body, both in the coordinates of an instance. No instance whose box does not meet
    /// that one bears on what stands between them.
    pub fn around_both(&self, other: &Self, scenery: &Scenery, instance: usize) -> Aabb {
        moved(self.bounds.union(other.bounds), &scenery.placement_of(instance))
    }

    /// Whether any of `other` may be before its plane.
    #[inline(always)]
    fn faces(&self, other: &Self) -> bool {
        let [x, y, z] = &other.corners;
        self.plane.is_none_or(|(normal, lowest)| {
            let mut heights = [0.0; LANES];
            for k in 0..LANES {
                heights[k] = normal.x * x[k] + normal.y * y[k] + normal.z * z[k];
            }
            range(&heights).1 > lowest
        })
    }
}

/// A plate that may stand between.
#[derive(Debug)]
pub struct Barrier {
    plate: Plate,
    bounds: Aabb,
    /// Distance from the plane and the two coordinates along the edges, as gradients and values at the origin.
    functions: [(DVec3, f64); 3],
    /// 1 for a triangle, whose third edge is 1 - a - b; 0 for a parallelogram, with 1 - a and 1 - b.
    diagonal: f64,
    /// Rounding of a distance, and of a coordinate.
    slack: [f64; 2],
}

/// What a plate does to the segments between two groups.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Stops {
    Nothing,
    Some,
    All,
}

impl Barrier {
    /// `largest`: the largest coordinate of places.
    fn new(plate: Plate, largest: f64) -> Self {
        let [u, v] = plate.edges;
        let normal = u.cross(v);
        let first = v.cross(normal) / normal.length_squared();
        let second = normal.cross(u) / normal.length_squared();
        let functions = [normal.normalize(), first, second].map(|g| (g, -g.dot(plate.corner)));
        let slack = [ROUNDING * largest, ON_EDGE + ROUNDING * largest * (first.length() + second.length())];
        Self {
            diagonal: if plate.is_parallelogram { 0.0 } else { 1.0 },
            bounds: plate.bounds(),
            plate,
            functions,
            slack,
        }
    }

    /// One of its functions at eight places.
    #[inline(always)]
    fn at(&self, function: usize, [x, y, z]: &Eight) -> [f64; LANES] {
        let (gradient, start) = self.functions[function];
        let mut values = [0.0; LANES];
        for k in 0..LANES {
            values[k] = gradient.x * x[k] + gradient.y * y[k] + gradient.z * z[k] + start;
        }
        values
    }

    /// All three, of which the first is known.
    #[inline(always)]
    fn all_at(&self, distance: [f64; LANES], places: &Eight) -> Eight {
        [distance, self.at(1, places), self.at(2, places)]
    }

    /// Whether it lies behind the plane of a group.
    #[inline(always)]
    fn is_behind(&self, hull: &Hull) -> bool {
        let Plate { corner, edges: [u, v], .. } = self.plate;
        hull.plane.is_some_and(|(normal, lowest)| {
            normal.dot(corner) + normal.dot(u).max(0.0) + normal.dot(v).max(0.0) < lowest - self.slack[0]
        })
    }

    #[inline(always)]
    fn effect(&self, from: &Hull, to: &Hull) -> Stops {
        if self.is_behind(from) || self.is_behind(to) {
            return Stops::Nothing;
        }
        let (here, there) = (self.at(0, &from.corners), self.at(0, &to.corners));
        let ((low, high), (low_there, high_there)) = (range(&here), range(&there));
        let off = self.slack[0];
        if low.min(low_there) > off || high.max(high_there) < -off {
            return Stops::Nothing;
        }
        if (low > off && high_there < -off) || (high < -off && low_there > off) {
            self.effect_across(&self.all_at(here, &from.corners), &self.all_at(there, &to.corners))
        } else {
            Stops::Some
        }
    }

    /// The same for groups on either side of the plane.
    #[inline(always)]
    fn effect_across(&self, here: &Eight, there: &Eight) -> Stops {
        let sign = here[0][0].signum();
        // The most that any crossing is inside of each edge, and the least that all are.
        let (mut most, mut least) = ([[f64::NEG_INFINITY; LANES]; 4], [f64::INFINITY; LANES]);
        let [s, a, b] = there;
        for ((&s1, &a1), &b1) in s.iter().zip(a).zip(b) {
            for k in 0..LANES {
                let s0 = here[0][k];
                let across = sign * (s0 - s1);
                let a = sign * (s0 * a1 - s1 * here[1][k]);
                let b = sign * (s0 * b1 - s1 * here[2][k]);
                let slack = self.slack[1] * across;
                let inside = [a, b, across - a - self.diagonal * b, across - b - self.diagonal * a];
                for (most, inside) in most.iter_mut().zip(inside) {
                    most[k] = max(most[k], inside + slack);
                }
                least[k] = min(least[k], min(min(a, b), min(inside[2], inside[3])) - slack);
            }
        }
        if most.iter().any(|most| range(most).1 < 0.0) {
            Stops::Nothing
        } else if range(&least).0 > 0.0 {
            Stops::All
        } else {
            Stops::Some
        }
    }

    /// Marks those of eight segments that it stops.
    #[inline(always)]
    fn stop(&self, from: &Eight, to: &Eight, stopped: &mut [bool; LANES]) {
        let (here, there) = (self.all_at(self.at(0, from), from), self.all_at(self.at(0, to), to));
        for k in 0..LANES {
            let (s0, s1) = (here[0][k], there[0][k]);
            let sign = if s0 > s1 { 1.0 } else { -1.0 };
            let across = sign * (s0 - s1);
            let a = sign * (s0 * there[1][k] - s1 * here[1][k]);
            let b = sign * (s0 * there[2][k] - s1 * here[2][k]);
            let inside = min(min(a, b), across - max(a, b) - self.diagonal * min(a, b));
            stopped[k] |= (s0 * s1 < 0.0) & (inside >= -self.slack[1] * across);
        }
    }
}

/// The lowest and the highest of eight numbers.
#[inline(always)]
fn range(values: &[f64; LANES]) -> (f64, f64) {
    let (mut low, mut high) = (*values, *values);
    for half in [4, 2, 1] {
        for k in 0..half {
            low[k] = min(low[k], low[k + half]);
            high[k] = max(high[k], high[k + half]);
        }
    }
    (low[0], high[0])
}

/// Unlike f64::max this becomes one instruction.
#[inline(always)]
fn max(a: f64, b: f64) -> f64 {
    if a > b { a } else { b }
}

/// Like [`max`].
#[inline(always)]
fn min(a: f64, b: f64) -> f64 {
    if a < b { a } else { b }
}

/// What lies between two groups.
#[derive(Debug)]
pub enum Between<B> {
    /// One plate hides them from each other, or they do not face each other.
    Hidden,
    /// No plates but these may stand between.
    Plates(B),
    /// So many things that each ray looks for itself.
    Crowd,
}

/// The plates between two groups in the coordinates of an instance.
pub fn between(scenery: &Scenery, instance: usize, from: &Hull, to: &Hull) -> Between<Vec<Barrier>> {
    if !from.faces(to) || !to.faces(from) {
        return Between::Hidden;
    }
    let around = from.bounds.union(to.bounds);
    let largest = around.low.abs().max(around.high.abs()).max_element();
    let Some(plates) = scenery.plates_in(instance, around, MOST_LEAVES) else { return Between::Crowd };
    let mut barriers = vec![];
    for plate in plates {
        if !plate.bounds().meets(&around) {
            continue;
        }
        let barrier = Barrier::new(plate, largest);
        match barrier.effect(from, to) {
            Stops::Nothing => {}
            Stops::Some => barriers.push(barrier),
            Stops::All => return Between::Hidden,
        }
    }
    if barriers.len() > MOST_PLATES { Between::Crowd } else { Between::Plates(barriers) }
}

/// Those of some plates that stand between two smaller groups.
pub type Few<'a> = SmallVec<[&'a Barrier; 8]>;

impl Between<Vec<Barrier>> {
    /// The same between parts of the two groups.
    #[inline(always)]
    pub fn narrowed(&self, from: &Hull, to: &Hull) -> Between<Few<'_>> {
        if !from.faces(to) || !to.faces(from) {
            return Between::Hidden;
        }
        let Self::Plates(barriers) = self else {
            return if matches!(self, Self::Crowd) { Between::Crowd } else { Between::Hidden };
        };
        let around = from.bounds.union(to.bounds);
        let mut few = Few::new();
        for barrier in barriers {
            if !barrier.bounds.meets(&around) {
                continue;
            }
            match barrier.effect(from, to) {
                Stops::Nothing => {}
                Stops::Some => few.push(barrier),
                Stops::All => return Between::Hidden,
            }
        }
        Between::Plates(few)
    }
}

/// Which of eight segments any of these plates stops.
#[inline(always)]
pub fn stopped(few: &Few, from: &Eight, to: &Eight) -> [bool; LANES] {
    let mut stopped = [false; LANES];
    for barrier in few {
        barrier.stop(from, to, &mut stopped);
    }
    stopped
}

#[cfg(test)]
mod tests {
    use super::super::shapes::{part, point, room, similarity, soup};
    use super::super::surfaces::Surfaces;
    use super::super::wide_tree::Ray;
    use super::*;
    use equilux_formats::{Corners, Element, FaceId, MaterialId};
    use proptest::prelude::*;
    use std::sync::Arc;

    /// A triangle or a parallelogram at a place, of up to a metre.
    fn area() -> impl Strategy<Value = Emitters> {
        (point(), point(), point(), any::<bool>()).prop_filter_map(
            "has an area",
            |(corner, u, v, is_triangle)| {
                let (u, v) = (u * 0.3, v * 0.3);
                let corners = [corner, corner + u, corner + u + v, corner + v];
                let [a, b, _, d] = corners;
                let corners = if is_triangle { Corners::triangle([a, b, d]) } else { Corners::quad(corners) };
                let has_area = u.cross(v).length() > 1e-3;
                has_area.then(|| Emitters::new(&[Element::new(corners, MaterialId(0), FaceId(0))]))
            },
        )
    }

    /// Eight segments between two areas that leave the front of both.
    fn segments(from: &Emitters, to: &Emitters, places: &[[f64; 4]]) -> Vec<Ray> {
        let rays = places.iter().map(|&[a, b, c, d]| {
            let ((p, normal), (q, normal_there)) = (from.place(a, b), to.place(c, d));
            let direction = q - p;
            let is_seen = normal.dot(direction) > 0.0 && normal_there.dot(direction) < 0.0;
            is_seen.then_some(Ray { origin: p, direction })
        });
        rays.flatten().collect()
    }

    proptest! {
        /// What plates found once for many segments say of each of them is what it finds for itself, whatever is placed how.
        #[test]
        fn a_segment_is_stopped_where_a_ray_is_blocked(
            parts in prop::collection::vec((prop_oneof![soup(), room()], similarity()), 1..5),
            (from, to) in (area(), area()),
            places in prop::collection::vec(prop::array::uniform4(0.0..1.0_f64), LANES),
        ) {
            let placed = parts.iter().map(|(faces, placement)| (Arc::new(Surfaces::new(&part(faces))), *placement));
            let scenery = Scenery::new(placed);
            let [here, there] = [&from, &to].map(|area| Hull::around(std::iter::once(area)));
            let all = Hull::around([&from, &to].into_iter());
            let (plain, group) = (between(&scenery, 0, &here, &there), between(&scenery, 0, &all, &there));
            for ray in segments(&from, &to, &places) {
                let is_blocked = scenery.is_blocked(0, &ray);
                let eight = |p: DVec3| p.to_array().map(|x| [x; LANES]);
                for between in [plain.narrowed(&here, &there), group.narrowed(&here, &there)] {
                    match between {
                        Between::Hidden => prop_assert!(is_blocked),
                        Between::Plates(few) => {
                            let stopped = stopped(&few, &eight(ray.origin), &eight(ray.at(1.0)));
                            prop_assert_eq!(stopped, [is_blocked; LANES]);
                        }
                        Between::Crowd => {}
                    }
                }
            }
        }

        /// A plate as large as the scene hides what is behind it; without it nothing is in the way.
        #[test]
        fn a_wall_hides_all_and_nothing_hides_none(height in 0.1..0.9_f64) {
            let square = |z: f64, size: f64, sign: f64| {
                let corner = DVec3::new(-size, -size * sign, z);
                let (u, v) = (DVec3::X * 2.0 * size, DVec3::Y * 2.0 * size * sign);
                [corner, corner + u, corner + u + v, corner + v]
            };
            let area = |corners| Emitters::new(&[Element::new(Corners::quad(corners), MaterialId(0), FaceId(0))]);
            let (low, high) = (area(square(0.0, 1.0, 1.0)), area(square(1.0, 1.0, -1.0)));
            let [here, there] = [&low, &high].map(|area| Hull::around(std::iter::once(area)));
            let scene = |faces: &[equilux_formats::Face]| {
                Scenery::new([(Arc::new(Surfaces::new(&part(faces))), glam::DAffine3::IDENTITY)])
            };
            let wall = equilux_formats::Face::new(square(height, 3.0, 1.0).to_vec());
            let is_hidden = matches!(between(&scene(&[wall]), 0, &here, &there), Between::Hidden);
            prop_assert!(is_hidden);
            let beyond = equilux_formats::Face::new(square(1.0 + height, 3.0, 1.0).to_vec());
            let found = between(&scene(&[beyond]), 0, &here, &there);
            prop_assert!(matches!(found, Between::Plates(few) if few.is_empty()));
        }
    }
}
