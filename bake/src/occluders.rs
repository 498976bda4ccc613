//! What blocks light: closed convex solids as a whole, all other faces one by one, in a hierarchy of boxes.
//!
//! Seen from a point outside, a convex solid hides exactly the pyramid over its silhouette: the loop of edges between
//! faces that look at the point and faces that do not.

use crate::form_factor::plain::IN_PLANE;
use crate::form_factor::polygon::{Polygon, Pyramid};
use crate::planes::FLATNESS;
use crate::visibility::BoxTree;
use equilux_formats::Face;
use glam::DVec3;
use smallvec::SmallVec;
use std::collections::HashMap;

/// All occluders of a world.
pub struct Occluders {
    /// The occluders.
    pub all: Vec<Occluder>,
    /// Their boxes.
    pub tree: BoxTree,
    /// The occluder that each face belongs to.
    pub of_face: Vec<u32>,
}

/// A face, or a closed convex solid.
pub struct Occluder {
    /// Lowest corner of its box.
    pub low: DVec3,
    /// Highest corner of its box.
    pub high: DVec3,
    /// Its corners.
    pub corners: Vec<DVec3>,
    /// Its faces: one, or all of a solid.
    pub faces: Vec<u32>,
    /// The edges of a solid; none of a single face.
    edges: Vec<Edge>,
}

/// An edge of a solid, counter-clockwise around the face on its left seen from outside.
struct Edge {
    ends: [DVec3; 2],
    /// Positions in the solid's list of faces.
    left: u32,
    right: u32,
}

impl Occluders {
    /// The occluders that `faces` make.
    pub fn new(faces: &[Face]) -> Self {
        let mut all = Vec::new();
        let mut of_face = vec![u32::MAX; faces.len()];
        for group in connected(faces) {
            if let Some(solid) = convex_solid(&group, faces) {
                group.iter().for_each(|&face| of_face[face as usize] = all.len() as u32);
                all.push(solid);
            } else {
                for face in group {
                    of_face[face as usize] = all.len() as u32;
                    all.push(Occluder::new(faces[face as usize].corners.clone(), vec![face], vec![]));
                }
            }
        }
        let boxes: Vec<(DVec3, DVec3)> = all.iter().map(|o: &Occluder| (o.low, o.high)).collect();
        Self { tree: BoxTree::new(&boxes), all, of_face }
    }
}

impl Occluder {
    fn new(corners: Vec<DVec3>, faces: Vec<u32>, edges: Vec<Edge>) -> Self {
        let low = corners.iter().copied().fold(DVec3::INFINITY, DVec3::min);
        let high = corners.iter().copied().fold(DVec3::NEG_INFINITY, DVec3::max);
        Self { low, high, corners, faces, edges }
    }

    /// Whether it is a closed convex solid.
    pub fn is_solid(&self) -> bool {
        !self.edges.is_empty()
    }

    /// The pyramid it hides from `point`; none if it is seen edge-on. From inside a solid everything is hidden.
    pub fn pyramid(&self, point: DVec3, faces: &[Face]) -> Option<Pyramid> {
        if self.is_solid() {
            return Some(self.silhouette(point, faces));
        }
        let normal = faces[self.faces[0] as usize].normal;
        face_pyramid(&self.corners, normal, point)
    }

    fn silhouette(&self, point: DVec3, faces: &[Face]) -> Pyramid {
        let looks = self.faces_that_look_at(point, faces);
        Pyramid::between(self.silhouette_edges(&looks).map(|(a, b)| inwards(a - point, b - point)).collect())
    }

    /// The pyramid that the piece of a solid where `height` is above zero hides from `point`, whose own height is above
    /// zero. The piece is convex as well: its silhouette follows the solid's, and closes along the cut through the
    /// faces that look at the point.
    pub fn pyramid_above(&self, point: DVec3, faces: &[Face], height: impl Fn(DVec3) -> f64) -> Pyramid {
        let looks = self.faces_that_look_at(point, faces);
        let above = |&(a, b): &(DVec3, DVec3)| height(a) > 0.0 || height(b) > 0.0;
        let mut planes: Polygon =
            self.silhouette_edges(&looks).filter(above).map(|(a, b)| inwards(a - point, b - point)).collect();
        for (&face, _) in self.faces.iter().zip(&looks).filter(|&(_, &looks)| looks) {
            if let Some((a, b)) = cut_edge(&faces[face as usize].corners, &height) {
                planes.push(inwards(a - point, b - point));
            }
        }
        Pyramid::between(planes)
    }

    fn faces_that_look_at(&self, point: DVec3, faces: &[Face]) -> SmallVec<[bool; 16]> {
        let looks = |&face: &u32| {
            let face = &faces[face as usize];
            let to_corner = face.corners[0] - point;
            face.normal.dot(to_corner) < -IN_PLANE * to_corner.length()
        };
        self.faces.iter().map(looks).collect()
    }

    /// The edges between faces that look and faces that do not, counter-clockwise around those that look.
    fn silhouette_edges<'a>(&'a self, looks: &'a [bool]) -> impl Iterator<Item = (DVec3, DVec3)> + 'a {
        self.edges.iter().filter_map(|edge| {
            let [a, b] = edge.ends;
            match (looks[edge.left as usize], looks[edge.right as usize]) {
                (true, false) => Some((a, b)),
                (false, true) => Some((b, a)),
                _ => None,
            }
        })
    }
}

/// The plane through the origin and an edge that runs counter-clockwise around a face that looks at the origin.
fn inwards(a: DVec3, b: DVec3) -> DVec3 {
    -a.cross(b - a)
}

/// Where a plane cuts a convex polygon: the edge that closes the piece above, in the piece's order.
fn cut_edge(corners: &[DVec3], height: impl Fn(DVec3) -> f64) -> Option<(DVec3, DVec3)> {
    let (mut exit, mut entry) = (None, None);
    for (i, &a) in corners.iter().enumerate() {
        let b = corners[(i + 1) % corners.len()];
        let (ha, hb) = (height(a), height(b));
        if (ha > 0.0) != (hb > 0.0) {
            let cut = a + (b - a) * (ha / (ha - hb));
            if ha > 0.0 { exit = Some(cut) } else { entry = Some(cut) }
        }
    }
    exit.zip(entry)
}

/// The pyramid over a polygon seen from `point`; none if it is seen edge-on.
pub fn face_pyramid(corners: &[DVec3], normal: DVec3, point: DVec3) -> Option<Pyramid> {
    let polygon: Polygon = corners.iter().map(|&p| p - point).collect();
    let reach = polygon.iter().map(|p| p.length_squared()).fold(0.0, f64::max).sqrt();
    (normal.dot(polygon[0]).abs() > IN_PLANE * reach).then(|| Pyramid::over(&polygon, normal))
}

/// A point as a key: equal to the bit.
type Bits = [u64; 3];

fn bits(p: DVec3) -> Bits {
    (p + 0.0).to_array().map(f64::to_bits)
}

fn edges(face: &Face) -> impl Iterator<Item = (DVec3, DVec3)> + '_ {
    let n = face.corners.len();
    (0..n).map(move |i| (face.corners[i], face.corners[(i + 1) % n]))
}

/// Faces that hang together by whole edges, in order of their first face.
fn connected(faces: &[Face]) -> Vec<Vec<u32>> {
    let mut first_at: HashMap<(Bits, Bits), usize> = HashMap::new();
    let mut group: Vec<usize> = (0..faces.len()).collect();
    for (number, face) in faces.iter().enumerate() {
        for (a, b) in edges(face) {
            let key = if bits(a) < bits(b) { (bits(a), bits(b)) } else { (bits(b), bits(a)) };
            let other = *first_at.entry(key).or_insert(number);
            let (x, y) = (find(&mut group, number), find(&mut group, other));
            group[x.max(y)] = x.min(y);
        }
    }
    let mut members: Vec<Vec<u32>> = vec![vec![]; faces.len()];
    for number in 0..faces.len() {
        let root = find(&mut group, number);
        members[root].push(number as u32);
    }
    members.retain(|group| !group.is_empty());
    members
}

fn find(group: &mut [usize], mut i: usize) -> usize {
    while group[i] != i {
        group[i] = group[group[i]];
        i = group[i];
    }
    i
}

/// The solid that these connected faces bound, if each edge lies between two of them and every corner behind all.
fn convex_solid(group: &[u32], faces: &[Face]) -> Option<Occluder> {
    if group.len() < 4 {
        return None;
    }
    let mut right_of: HashMap<(Bits, Bits), u32> = HashMap::new();
    for (position, &face) in group.iter().enumerate() {
        for (a, b) in edges(&faces[face as usize]) {
            if right_of.insert((bits(b), bits(a)), position as u32).is_some() {
                return None;
            }
        }
    }
    let mut solid_edges = Vec::new();
    for (position, &face) in group.iter().enumerate() {
        for (a, b) in edges(&faces[face as usize]) {
            let right = *right_of.get(&(bits(a), bits(b)))?;
            if position < right as usize {
                solid_edges.push(Edge { ends: [a, b], left: position as u32, right });
            }
        }
    }
    let mut corners: Vec<DVec3> =
        group.iter().flat_map(|&f| faces[f as usize].corners.iter().copied()).collect();
    corners.sort_by_key(|&p| bits(p));
    corners.dedup();
    let size = corners.iter().map(|&p| (p - corners[0]).length()).fold(0.0, f64::max);
    let behind =
        |face: &Face| corners.iter().all(|&p| face.normal.dot(p - face.corners[0]) <= FLATNESS * size);
    group
        .iter()
        .all(|&face| behind(&faces[face as usize]))
        .then(|| Occluder::new(corners, group.to_vec(), solid_edges))
}
