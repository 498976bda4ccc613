//! Occluders: closed convex solids and curved meshes as a whole, all other faces one by one, in a hierarchy of boxes.
//!
//! Seen from a point outside, a convex solid hides exactly the pyramid over its silhouette: the loop of edges between
//! faces that face the point and faces that do not. [`crate::meshes`] computes what a mesh hides.

use crate::geometry::aabb::Aabb;
use crate::geometry::box_tree::{BoxTree, Inside};
use crate::geometry::outline::{Edge, Outline, Plane};
use crate::geometry::point_key::{EdgeKey, edge_keys, point_key};
use crate::geometry::shells::groups_by_edges;
use crate::geometry::tolerance::FLATNESS;
use crate::meshes::Mesh;
use equilux_formats::Face;
use glam::DVec3;
use std::collections::HashMap;

/// All occluders of a world.
#[derive(Debug)]
pub struct Occluders {
    /// The occluders, followed by the faces of meshes.
    pub all: Vec<Occluder>,
    /// Their boxes, without those of the faces of meshes.
    pub tree: BoxTree,
    /// The occluder that each face belongs to.
    pub of_face: Vec<u32>,
}

/// A face, or faces that occlude as a whole.
#[derive(Debug)]
pub struct Occluder {
    /// The box around it.
    pub bounds: Aabb,
    /// Diagonal of its box.
    pub diameter: f64,
    /// Its corners; of a mesh, those of its box.
    pub corners: Vec<DVec3>,
    /// Its faces: one, or all that occlude as a whole.
    pub faces: Vec<u32>,
    /// Its kind, with the data to compute what it hides.
    pub shape: Shape,
}

/// The kinds of occluders.
#[derive(Debug)]
pub enum Shape {
    /// One face, by its edges.
    Face(Outline),
    /// A closed convex solid, by its edges; sides are in the order of the faces.
    Solid(Outline),
    /// A mesh of any shape, by its silhouette.
    Mesh(Box<Together>),
}

/// A mesh that occludes as a whole or, where only few of its faces matter, face by face.
#[derive(Debug)]
pub struct Together {
    /// The mesh.
    pub mesh: Mesh,
    /// The boxes of its faces.
    pub tree: BoxTree,
    /// The occluder of its first face; those of the other faces follow.
    pub first: u32,
}

/// Groups of fewer connected faces occlude face by face: a silhouette would hardly be shorter than their edges.
const MESH: usize = 24;

/// Faces occlude as a mesh if most edges bend by less than the angle of this cosine, 45°. Surfaces that bend more, such
/// as a building's shell, have few, large faces. One of these alone can hide whole clusters from each other, which is
/// found sooner face by face.
const BEND: f64 = std::f64::consts::FRAC_1_SQRT_2;

impl Occluders {
    /// The occluders of a world with these faces. `lit_behind` marks faces with elements on their back: a solid that is
    /// also seen from inside occludes face by face.
    pub fn new(faces: &[Face], lit_behind: &[bool]) -> Self {
        let mut all = Vec::new();
        let mut of_face = vec![u32::MAX; faces.len()];
        let mut add = |occluder: Occluder| {
            occluder.faces.iter().for_each(|&face| of_face[face as usize] = all.len() as u32);
            all.push(occluder);
        };
        let polygons: Vec<&[DVec3]> = faces.iter().map(|face| face.corners.as_slice()).collect();
        for group in groups_by_edges(&polygons) {
            let group: Vec<u32> = group.into_iter().map(|face| face as u32).collect();
            let hollow = group.iter().any(|&face| lit_behind[face as usize]);
            if let Some(solid) = convex_solid(&group, faces).filter(|_| !hollow) {
                add(solid);
            } else if is_curved(&group, faces) {
                add(Occluder::mesh(group, faces));
            } else {
                group.into_iter().for_each(|face| add(Occluder::face(face, &faces[face as usize])));
            }
        }
        let tree = tree(&all);
        for number in 0..all.len() {
            let first = all.len() as u32;
            let Shape::Mesh(together) = &mut all[number].shape else { continue };
            together.first = first;
            let inside = all[number].faces.iter().map(|&f| Occluder::face(f, &faces[f as usize]));
            all.extend(inside.collect::<Vec<_>>());
        }
        Self { tree, all, of_face }
    }

    /// Whether `found` returns true for any occluder whose box, and the boxes around it, `misses` does not exclude.
    pub fn any(&self, misses: impl Fn(&Aabb) -> bool, mut found: impl FnMut(&Occluder) -> bool) -> bool {
        let mut open: Vec<usize> = self.tree.root().into_iter().collect();
        while let Some(index) = open.pop() {
            let node = self.tree.node(index);
            if misses(&node.bounds) {
                continue;
            }
            match self.tree.inside(index) {
                Inside::Boxes(pair) => open.extend(pair),
                Inside::Things(things) => {
                    let mut things = things.iter().map(|&thing| &self.all[thing as usize]);
                    if things.any(|occluder| !misses(&occluder.bounds) && found(occluder)) {
                        return true;
                    }
                }
            }
        }
        false
    }

    /// An occluder, if it is a mesh.
    pub fn mesh(&self, occluder: u32) -> Option<&Mesh> {
        match &self.all[occluder as usize].shape {
            Shape::Mesh(together) => Some(&together.mesh),
            Shape::Face(_) | Shape::Solid(_) => None,
        }
    }
}

impl Occluder {
    fn new(corners: Vec<DVec3>, faces: Vec<u32>, shape: Shape) -> Self {
        let bounds = Aabb::around(&corners);
        Self { bounds, diameter: bounds.diagonal(), corners, faces, shape }
    }

    fn face(number: u32, Face { corners, normal }: &Face) -> Self {
        Self::new(corners.clone(), vec![number], Shape::Face(Outline::of_face(corners, *normal)))
    }

    fn mesh(group: Vec<u32>, faces: &[Face]) -> Self {
        let mesh = Mesh::from_faces(&group, faces);
        let inside: Vec<Self> = group.iter().map(|&f| Self::face(f, &faces[f as usize])).collect();
        let corners = mesh.bounds.corners().to_vec();
        Self::new(
            corners,
            group,
            Shape::Mesh(Box::new(Together { mesh, tree: tree(&inside), first: u32::MAX })),
        )
    }
}

fn tree(occluders: &[Occluder]) -> BoxTree {
    BoxTree::new(&occluders.iter().map(|o| o.bounds).collect::<Vec<_>>())
}

fn edges(face: &Face) -> impl Iterator<Item = (DVec3, DVec3)> + '_ {
    let n = face.corners.len();
    (0..n).map(move |i| (face.corners[i], face.corners[(i + 1) % n]))
}

/// Whether these connected faces are a tessellated curved surface: see [`BEND`]. Flat edges do not count.
fn is_curved(group: &[u32], faces: &[Face]) -> bool {
    if group.len() < MESH {
        return false;
    }
    let mut first_at: HashMap<EdgeKey, &Face> = HashMap::new();
    let (mut bent, mut little) = (0, 0);
    for face in group.iter().map(|&face| &faces[face as usize]) {
        for (edge, _) in edge_keys(&face.corners) {
            let Some(other) = first_at.insert(edge, face) else { continue };
            let cosine = face.normal.dot(other.normal).abs();
            let flat = face.normal.cross(other.normal).length() <= FLATNESS;
            bent += usize::from(!flat);
            little += usize::from(!flat && cosine > BEND);
        }
    }
    2 * little > bent
}

/// The solid that these connected faces bound, if each edge lies between two of them and every corner behind all.
fn convex_solid(group: &[u32], faces: &[Face]) -> Option<Occluder> {
    if group.len() < 4 {
        return None;
    }
    let mut right_of: HashMap<EdgeKey, u32> = HashMap::new();
    for (position, &face) in group.iter().enumerate() {
        for (a, b) in edges(&faces[face as usize]) {
            if right_of.insert([point_key(b), point_key(a)], position as u32).is_some() {
                return None;
            }
        }
    }
    let mut solid_edges = Vec::new();
    for (position, &face) in group.iter().enumerate() {
        for (a, b) in edges(&faces[face as usize]) {
            let right = *right_of.get(&[point_key(a), point_key(b)])?;
            if position < right as usize {
                solid_edges.push(Edge { ends: [a, b], left: position as u32, right });
            }
        }
    }
    let mut corners: Vec<DVec3> =
        group.iter().flat_map(|&f| faces[f as usize].corners.iter().copied()).collect();
    corners.sort_by_key(|&p| point_key(p));
    corners.dedup();
    let size = corners.iter().map(|&p| (p - corners[0]).length()).fold(0.0, f64::max);
    let behind =
        |face: &Face| corners.iter().all(|&p| face.normal.dot(p - face.corners[0]) <= FLATNESS * size);
    group.iter().all(|&face| behind(&faces[face as usize])).then(|| {
        let side = |&face: &u32| {
            let face = &faces[face as usize];
            Plane { normal: face.normal, point: face.corners[0] }
        };
        let sides = group.iter().map(side).collect();
        let outline = Outline { sides, edges: solid_edges, size: 2.0 * size, thin: false };
        Occluder::new(corners, group.to_vec(), Shape::Solid(outline))
    })
}
