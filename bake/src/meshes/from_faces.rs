//! Builds a mesh from faces: its corners and edges, and properties of the whole.

use super::mesh::{Edge, Mesh, steps};
use super::touching_itself::touches_itself;
use crate::geometry::aabb::Aabb;
use crate::geometry::box_tree::{BoxTree, Inside};
use crate::geometry::point_key::point_key;
use crate::geometry::tolerance::FLATNESS;
use equilux_formats::Face;
use std::collections::HashMap;

impl Mesh {
    /// The mesh of `group`, some of `faces`. They should be connected: loose triangles are allowed, but every edge of
    /// theirs belongs to the silhouette.
    pub fn from_faces(group: &[u32], faces: &[Face]) -> Self {
        let tree = BoxTree::new(
            &group.iter().map(|&f| Aabb::around(&faces[f as usize].corners)).collect::<Vec<_>>(),
        );
        let mut mesh = Self::without_edges(group, in_order(&tree).map(|i| group[i]).collect(), faces);
        mesh.edges = mesh.find_edges();
        mesh.touches_itself = touches_itself(&mesh);
        mesh.bounds_a_solid = !mesh.touches_itself && mesh.edges.iter().all(|edge| edge.right.is_some());
        mesh.looks_out = mesh.volume() > 0.0;
        mesh
    }

    fn without_edges(group: &[u32], order: Vec<u32>, faces: &[Face]) -> Self {
        let mut corners = Vec::new();
        let mut numbers = HashMap::new();
        let (mut loops, mut first) = (vec![], vec![0]);
        for &face in &order {
            for &corner in &faces[face as usize].corners {
                loops.push(*numbers.entry(point_key(corner)).or_insert_with(|| {
                    corners.push(corner);
                    corners.len() as u32 - 1
                }));
            }
            first.push(loops.len() as u32);
        }
        let mut sorted = group.to_vec();
        sorted.sort_unstable();
        Self {
            bounds: Aabb::around(&corners),
            normals: order.iter().map(|&face| faces[face as usize].normal).collect(),
            faces: order,
            corners,
            bounds_a_solid: false,
            edges: vec![],
            touches_itself: false,
            looks_out: false,
            loops,
            first,
            sorted,
        }
    }

    fn find_edges(&self) -> Vec<Edge> {
        let mut left_of: HashMap<[u32; 2], Vec<u32>> = HashMap::new();
        for face in 0..self.faces.len() {
            for ends in steps(self.around(face)) {
                left_of.entry(ends).or_default().push(face as u32);
            }
        }
        let mut edges = Vec::with_capacity(left_of.len() / 2);
        for left in 0..self.faces.len() as u32 {
            for [a, b] in steps(self.around(left as usize)) {
                match (left_of[&[a, b]].as_slice(), left_of.get(&[b, a]).map(Vec::as_slice)) {
                    ([_], Some(&[right])) if left > right => {}
                    ([_], Some(&[right])) => {
                        let rise = self.rise(left as usize, right as usize);
                        edges.push(Edge { ends: [a, b], left, right: Some(right), rise });
                    }
                    _ => edges.push(Edge { ends: [a, b], left, right: None, rise: 0.0 }),
                }
            }
        }
        edges
    }

    /// Height of the face `other` in front of `face`, zero if it lies in its plane.
    fn rise(&self, face: usize, other: usize) -> f64 {
        let (normal, origin) = (self.normals[face], self.corners[self.around(face)[0] as usize]);
        let height = |&corner: &u32| normal.dot(self.corners[corner as usize] - origin);
        let furthest = |a: f64, b: f64| if b.abs() > a.abs() { b } else { a };
        let rise = self.around(other).iter().map(height).fold(0.0, furthest);
        if rise.abs() <= FLATNESS * self.bounds.diagonal() { 0.0 } else { rise }
    }

    /// Six times the volume that a closed mesh encloses, negative if its fronts face inwards.
    fn volume(&self) -> f64 {
        let cone = |face: usize| {
            let around = self.around(face);
            let at = |i: usize| self.corners[around[i] as usize] - self.bounds.low;
            (1..around.len() - 1).map(|i| at(0).dot(at(i).cross(at(i + 1)))).sum::<f64>()
        };
        (0..self.faces.len()).map(cone).sum()
    }
}

/// The items of a hierarchy in an order in which neighbours are near each other.
fn in_order(tree: &BoxTree) -> impl Iterator<Item = usize> + '_ {
    let mut open: Vec<usize> = tree.root().into_iter().collect();
    let mut things: &[u32] = &[];
    std::iter::from_fn(move || {
        while things.is_empty() {
            match tree.inside(open.pop()?) {
                Inside::Boxes([left, right]) => open.extend([right, left]),
                Inside::Things(inside) => things = inside,
            }
        }
        let (&first, rest) = things.split_first()?;
        things = rest;
        Some(first as usize)
    })
}
