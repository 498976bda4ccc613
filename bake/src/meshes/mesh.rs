//! A mesh of faces: corners, edges, and properties of the whole.

use crate::geometry::aabb::Aabb;
use glam::DVec3;

/// A mesh of planar convex faces, of any shape. Corners are the same if they are equal to the bit.
#[derive(Debug)]
pub struct Mesh {
    /// The box around it.
    pub bounds: Aabb,
    /// The faces, by their numbers in the world; neighbours in this list are near each other.
    pub faces: Vec<u32>,
    /// All corners, once each.
    pub corners: Vec<DVec3>,
    /// Whether it bounds a solid, or a hollow: every edge lies between two faces that agree on which side is out, and
    /// it does not touch itself elsewhere.
    pub bounds_a_solid: bool,
    pub(super) edges: Vec<Edge>,
    /// Whether it intersects or touches itself.
    pub(super) touches_itself: bool,
    /// Whether fronts face outwards, and not into a hollow.
    pub(super) looks_out: bool,
    /// Corner numbers of all faces, and where each face's begin.
    pub(super) loops: Vec<u32>,
    pub(super) first: Vec<u32>,
    pub(super) normals: Vec<DVec3>,
    /// The faces in rising order.
    pub(super) sorted: Vec<u32>,
}

/// An edge, counter-clockwise around the face on its left seen from the front.
#[derive(Debug)]
pub(super) struct Edge {
    /// Corner numbers.
    pub ends: [u32; 2],
    /// Position of a face in the mesh's list.
    pub left: u32,
    /// The face that runs along the edge the other way, unless there is none, or more than one.
    pub right: Option<u32>,
    /// How far the face on the right rises in front of the face on the left: below zero at a ridge, above in a groove,
    /// zero if flat.
    pub rise: f64,
}

impl Mesh {
    /// Whether a face, by its number in the world, belongs to the mesh.
    pub fn has(&self, face: u32) -> bool {
        self.sorted.binary_search(&face).is_ok()
    }

    /// Corner numbers around a face, by its position in the list.
    pub(super) fn around(&self, face: usize) -> &[u32] {
        &self.loops[self.first[face] as usize..self.first[face + 1] as usize]
    }

    /// Unit normal of a face, by its position in the list.
    pub(super) fn normal(&self, face: usize) -> DVec3 {
        self.normals[face]
    }
}

/// The edges of a loop of corners.
pub(super) fn steps(around: &[u32]) -> impl Iterator<Item = [u32; 2]> + '_ {
    let last = around[around.len() - 1];
    around.iter().scan(last, |before, &corner| Some([std::mem::replace(before, corner), corner]))
}
