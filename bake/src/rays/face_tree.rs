//! The first face of a part that a ray meets, in the part's coordinates.
//!
//! A tree of eight boxes a node, in f32, proposes plates; the face itself is then met in f64. A place on an edge belongs to both
//! faces, so no ray slips through between them.

use super::lanes::LANES;
use super::plates::{Plate, Plates};
use super::wide_tree::{Ray, Ray32, Visitor, WideTree};
use crate::geometry::aabb::Aabb;
use crate::geometry::tolerance::{SAME_HIT, TRIPLE_PRODUCT};
use equilux_formats::Face;
use glam::DVec3;
use smallvec::SmallVec;

/// A face that a ray meets.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FaceHit {
    /// Where on the ray.
    pub t: f64,
    /// The face's number in its part.
    pub face: u32,
    /// Whether its front is met.
    pub front: bool,
}

impl FaceHit {
    /// Whether this is met before `other`. Of two at the same place the one whose front is met comes first, then the
    /// one with the lower number, so that the answer does not depend on the order in which they are found.
    #[inline(always)]
    pub fn is_before(&self, other: &Self) -> bool {
        if (self.t - other.t).abs() > SAME_HIT * other.t {
            return self.t < other.t;
        }
        if self.front == other.front { self.face < other.face } else { self.front }
    }
}

/// The faces of a part in a tree.
#[derive(Debug)]
pub struct FaceTree {
    faces: Vec<Face>,
    planes: Vec<Plane>,
    tree: WideTree,
    /// The plates of each leaf.
    plates: Vec<Plates>,
}

impl FaceTree {
    /// The tree over these faces.
    pub fn new(faces: &[Face]) -> Self {
        let all: Vec<Plate> = faces.iter().enumerate().flat_map(|(n, face)| plates(n as u32, face)).collect();
        let boxes: Vec<Aabb> = all.iter().map(Plate::bounds).collect();
        let tree = WideTree::new(&boxes, LANES);
        let leaf = |items: &Vec<u32>| {
            let own: Vec<Plate> = items.iter().map(|&item| all[item as usize]).collect();
            Plates::new(&own, tree.centre)
        };
        let plane = |face: &Face| Plane { corner: face.corners[0], normal: face.normal };
        Self {
            plates: tree.leaves().iter().map(leaf).collect(),
            planes: faces.iter().map(plane).collect(),
            faces: faces.to_vec(),
            tree,
        }
    }

    /// The faces.
    pub fn faces(&self) -> &[Face] {
        &self.faces
    }

    /// The box around all faces.
    pub fn bounds(&self) -> Aabb {
        self.tree.bounds
    }

    /// The plates of the faces in leaves whose boxes meet `around`, each once; none if there are more than `most` leaves.
    pub fn plates_in(&self, around: &Aabb, most: usize) -> Option<Vec<Plate>> {
        let leaves = self.tree.meeting(around, most)?;
        let mut faces: Vec<u32> = leaves.into_iter().flat_map(|leaf| self.plates[leaf].faces).collect();
        faces.sort_unstable();
        faces.dedup();
        // What fills a leaf up is the number of no face.
        let faces = faces.into_iter().filter_map(|number| Some((number, self.faces.get(number as usize)?)));
        Some(faces.flat_map(|(number, face)| plates(number, face)).collect())
    }

    /// The first face on the ray with t up to `most`.
    #[inline(always)]
    pub fn first(&self, ray: &Ray, most: f64) -> Option<FaceHit> {
        let mut search = Search::<false> { tree: self, ray, nearest: None, most };
        self.tree.along(ray, most, &mut search);
        search.nearest
    }

    /// Whether any face is met with t up to `most`.
    #[inline(always)]
    pub fn is_met(&self, ray: &Ray, most: f64) -> bool {
        let mut search = Search::<true> { tree: self, ray, nearest: None, most };
        self.tree.along(ray, most, &mut search);
        search.nearest.is_some()
    }

    /// The first face on the ray, found by looking at every face.
    pub fn first_of_all(&self, ray: &Ray, most: f64) -> Option<FaceHit> {
        let hits = (0..self.faces.len()).filter_map(|face| self.meet(face as u32, ray, most));
        hits.reduce(|nearest, hit| if hit.is_before(&nearest) { hit } else { nearest })
    }

    /// Where the ray meets a face with t up to `most`, in f64.
    #[inline(always)]
    fn meet(&self, number: u32, ray: &Ray, most: f64) -> Option<FaceHit> {
        let hit = self.planes[number as usize].meet(number, ray, most)?;
        is_inside(&self.faces[number as usize], ray, hit.front).then_some(hit)
    }
}

/// The plane of a face.
#[derive(Debug)]
struct Plane {
    corner: DVec3,
    normal: DVec3,
}

impl Plane {
    /// Where the ray meets the plane of this face with t up to `most`.
    #[inline(always)]
    fn meet(&self, face: u32, ray: &Ray, most: f64) -> Option<FaceHit> {
        let approach = self.normal.dot(ray.direction);
        let t = self.normal.dot(self.corner - ray.origin) / approach;
        (t > 0.0 && t <= most).then_some(FaceHit { t, face, front: approach < 0.0 })
    }
}

/// Whether the ray, which meets the plane of a face, passes between its edges.
#[inline(always)]
fn is_inside(face: &Face, ray: &Ray, front: bool) -> bool {
    let corners = face.corners.as_slice();
    let sign = if front { -1.0 } else { 1.0 };
    let mut from = corners[corners.len() - 1] - ray.origin;
    let mut from_length = from.length_squared();
    let longest = ray.direction.length_squared();
    for corner in corners {
        let to = *corner - ray.origin;
        let to_length = to.length_squared();
        // Both faces that share the edge get the same number, but the edges that meet in a corner each round their
        // own way: without this much tolerance a ray at the corner might pass outside of all of them.
        let triple = from.cross(to).dot(ray.direction) * sign;
        if triple < 0.0
            && triple * triple > TRIPLE_PRODUCT * TRIPLE_PRODUCT * (from_length * to_length * longest)
        {
            return false;
        }
        (from, from_length) = (to, to_length);
    }
    true
}

/// Looks for the first face on a ray, or for any.
struct Search<'a, const ANY: bool> {
    tree: &'a FaceTree,
    ray: &'a Ray,
    nearest: Option<FaceHit>,
    /// How far to look: a hit this far away may still come before the nearest.
    most: f64,
}

impl<const ANY: bool> Visitor for Search<'_, ANY> {
    #[inline(always)]
    fn leaf(&mut self, leaf: usize, ray32: &Ray32, limit: f32, mut most: f64) -> f64 {
        let plates = &self.tree.plates[leaf];
        let (met, within) = plates.met(ray32, limit);
        for lane in met {
            let face = plates.faces[lane];
            let Some(hit) = self.tree.planes[face as usize].meet(face, self.ray, self.most) else { continue };
            if !within.has(lane) && !is_inside(&self.tree.faces[face as usize], self.ray, hit.front) {
                continue;
            }
            if self.nearest.is_none_or(|nearest| hit.is_before(&nearest)) {
                self.nearest = Some(hit);
                most = if ANY { -1.0 } else { hit.t };
                self.most = self.most.min(hit.t * (1.0 + 2.0 * SAME_HIT));
            }
        }
        most
    }
}

/// The triangles and parallelograms of a face.
fn plates(number: u32, face: &Face) -> SmallVec<[Plate; 1]> {
    let corners = &face.corners;
    let plate = |corner: DVec3, u: DVec3, v: DVec3, is_parallelogram| Plate {
        face: number,
        corner,
        edges: [u - corner, v - corner],
        is_parallelogram,
    };
    if let &[a, b, c, d] = corners.as_slice()
        && ((a + c) - (b + d)).abs().max_element() <= SAME_HIT * (c - a).length()
    {
        return SmallVec::from([plate(a, b, d, true)]);
    }
    // A fan. Its triangles may be slivers, so what they miss by rounding is met by their neighbours' slack.
    let fan = corners.windows(2).skip(1).map(|edge| plate(corners[0], edge[0], edge[1], false));
    fan.filter(|plate| plate.edges[0].cross(plate.edges[1]) != DVec3::ZERO).collect()
}

#[cfg(test)]
mod tests {
    use super::super::shapes::{aim, globe, point, room, rotation, soup};
    use super::*;
    use proptest::prelude::*;

    fn placed(faces: &[Face], place: impl Fn(DVec3) -> DVec3) -> Vec<Face> {
        faces
            .iter()
            .map(|face| Face::new(face.corners.iter().map(|&corner| place(corner)).collect()))
            .collect()
    }

    /// Inside of what is within 2 of the origin, near it, or up to 1000 extents away.
    fn origin() -> impl Strategy<Value = DVec3> {
        (point(), prop_oneof![Just(0.5), Just(2.0), Just(30.0), Just(4000.0)]).prop_map(|(p, far)| p * far)
    }

    proptest! {
        #[test]
        fn the_first_face_is_the_first_of_all(
            faces in prop_oneof![soup(), room()],
            (turn, moved) in (rotation(), point()),
            (from, at, length) in (origin(), aim(), -3.0..3.0_f64),
        ) {
            let faces = placed(&faces, |p| turn * p + moved * 100.0);
            let tree = FaceTree::new(&faces);
            let origin = turn * from + moved * 100.0;
            let at = at.at(&faces);
            let stretch = 10f64.powf(length);
            // From either side of what it is aimed at, and up to there, short of it and beyond.
            for origin in [origin, at * 2.0 - origin] {
                let ray = Ray { origin, direction: (at - origin) * stretch };
                for most in [f64::INFINITY, 1.0 / stretch, 0.9 / stretch] {
                    let (first, expected) = (tree.first(&ray, most), tree.first_of_all(&ray, most));
                    prop_assert_eq!(first, expected, "{:?} up to {}", ray, most);
                    prop_assert_eq!(tree.is_met(&ray, most), expected.is_some());
                }
            }
        }

        #[test]
        fn no_ray_leaves_a_closed_room(
            faces in prop_oneof![room(), globe()],
            (from, near, at) in (aim(), prop_oneof![Just(1e-9), Just(1e-3), 0.1..1.0], aim()),
        ) {
            // Both are convex with the origin inside, so this is inside, at any distance from a face, an edge or a corner.
            let origin = from.at(&faces) * (1.0 - near);
            let ray = Ray { origin, direction: at.at(&faces) - origin };
            prop_assume!(ray.direction != DVec3::ZERO);
            let tree = FaceTree::new(&faces);
            prop_assert!(tree.first(&ray, f64::INFINITY).is_some(), "{:?}", ray);
            // Away from what was aimed at there is a face too.
            let ray = Ray { direction: -ray.direction, ..ray };
            prop_assert!(tree.first(&ray, f64::INFINITY).is_some(), "{:?}", ray);
        }
    }
}
