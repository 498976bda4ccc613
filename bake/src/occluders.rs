//! What blocks light: closed convex solids as a whole, all other faces one by one, in a hierarchy of boxes.
//!
//! Seen from a point outside, a convex solid hides exactly the pyramid over its silhouette: the loop of edges between
//! faces that look at the point and faces that do not.

use crate::outline::{Edge, Outline, Plane};
use crate::planes::FLATNESS;
use crate::visibility::BoxTree;
use equilux_formats::Face;
use glam::DVec3;
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
    /// Diagonal of its box.
    pub diameter: f64,
    /// Its corners.
    pub corners: Vec<DVec3>,
    /// Its faces: one, or all of a solid.
    pub faces: Vec<u32>,
    /// Its edges; sides are in the order of `faces`.
    pub outline: Outline,
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
                    let Face { corners, normal } = &faces[face as usize];
                    all.push(Occluder::new(corners.clone(), vec![face], Outline::of_face(corners, *normal)));
                }
            }
        }
        let boxes: Vec<(DVec3, DVec3)> = all.iter().map(|o: &Occluder| (o.low, o.high)).collect();
        Self { tree: BoxTree::new(&boxes), all, of_face }
    }
}

impl Occluder {
    fn new(corners: Vec<DVec3>, faces: Vec<u32>, outline: Outline) -> Self {
        let low = corners.iter().copied().fold(DVec3::INFINITY, DVec3::min);
        let high = corners.iter().copied().fold(DVec3::NEG_INFINITY, DVec3::max);
        Self { low, high, diameter: (high - low).length(), corners, faces, outline }
    }

    /// Whether it is a closed convex solid.
    pub fn is_solid(&self) -> bool {
        !self.outline.thin
    }
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
        .then(|| {
            let side = |&face: &u32| {
                let face = &faces[face as usize];
                Plane { normal: face.normal, point: face.corners[0] }
            };
            let sides = group.iter().map(side).collect();
            let outline = Outline { sides, edges: solid_edges, size: 2.0 * size, thin: false };
            Occluder::new(corners, group.to_vec(), outline)
        })
}
