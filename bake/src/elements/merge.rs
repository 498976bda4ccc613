//! Merges coplanar polygons that share an edge into larger convex polygons, for fewer and larger occluders.
//!
//! In each plane, polygons first grow into strips along one direction, then in any direction. A regular grid becomes
//! one rectangle; a wall with a door becomes three or four.

use crate::geometry::disjoint_sets::DisjointSets;
use crate::geometry::planes;
use crate::geometry::point_key::point_key;
use crate::geometry::tolerance::{FLATNESS, LONGER};
use equilux_formats::Face;
use glam::DVec3;
use std::collections::HashMap;
use std::hash::Hash;

/// Merged polygons, and which of them each input polygon went into.
#[derive(Debug)]
pub struct Merged {
    /// The convex polygons.
    pub faces: Vec<Face>,
    /// For each input its face.
    pub of: Vec<u32>,
}

/// Merges `polygons` (planar, convex, counter-clockwise from the front). Polygons are merged only if their `kind` is
/// equal and `accept` returns true for the corners of the union. Polygons share an edge if its ends are bit-identical.
pub fn merge<K: Copy + Eq + Hash>(
    polygons: &[Face],
    kind: impl Fn(usize) -> K,
    accept: impl Fn(&[DVec3]) -> bool,
) -> Merged {
    let planes = planes::group(polygons);
    let mut merger = Merger::new(polygons, |i| (planes[i], kind(i)));
    let strips = strip_directions(polygons, &planes);
    merger.grow(|plane, edge| edge.dot(strips[plane as usize]).abs() < 0.5 * edge.length(), &accept);
    merger.grow(|_, _| true, &accept);
    merger.finish()
}

/// In each plane the direction of the longest edge of its largest polygon.
fn strip_directions(polygons: &[Face], planes: &[u32]) -> Vec<DVec3> {
    let count = planes.iter().max().map_or(0, |&last| last as usize + 1);
    let mut longest = vec![DVec3::ZERO; count];
    for (polygon, &plane) in polygons.iter().zip(planes) {
        for (i, &a) in polygon.corners.iter().enumerate() {
            let edge = polygon.corners[(i + 1) % polygon.corners.len()] - a;
            if edge.length_squared() > longest[plane as usize].length_squared() * (1.0 + LONGER) {
                longest[plane as usize] = edge;
            }
        }
    }
    longest.into_iter().map(DVec3::normalize_or_zero).collect()
}

/// Plane and kind: only polygons of the same class are merged.
type Class<K> = (u32, K);

struct Merger<K> {
    positions: Vec<DVec3>,
    /// Corner numbers around each polygon; empty once it has gone into another.
    loops: Vec<Vec<u32>>,
    classes: Vec<Class<K>>,
    normals: Vec<DVec3>,
    /// The polygon on the left of each directed edge.
    left_of: HashMap<(Class<K>, u32, u32), u32>,
    /// The polygons that were merged.
    joined: DisjointSets,
    tolerance: f64,
}

impl<K: Copy + Eq + Hash> Merger<K> {
    fn new(polygons: &[Face], class: impl Fn(usize) -> Class<K>) -> Self {
        let mut numbers = HashMap::new();
        let mut positions = Vec::new();
        let mut number = |p: DVec3| {
            *numbers.entry(point_key(p)).or_insert_with(|| {
                positions.push(p);
                positions.len() as u32 - 1
            })
        };
        let loops: Vec<Vec<u32>> =
            polygons.iter().map(|f| f.corners.iter().map(|&p| number(p)).collect()).collect();
        let largest = positions.iter().map(|p| p.abs().max_element()).fold(0.0, f64::max);
        let mut merger = Self {
            classes: (0..loops.len()).map(class).collect(),
            normals: polygons.iter().map(|face| face.normal).collect(),
            left_of: HashMap::new(),
            joined: DisjointSets::new(loops.len()),
            tolerance: FLATNESS * largest,
            positions,
            loops,
        };
        (0..merger.loops.len()).for_each(|polygon| merger.enter(polygon));
        merger
    }

    /// Merges neighbours across every edge that `across` allows, until no more can be merged.
    fn grow(&mut self, across: impl Fn(u32, DVec3) -> bool, accept: &impl Fn(&[DVec3]) -> bool) {
        loop {
            let mut joined = false;
            for polygon in 0..self.loops.len() {
                while self.join_one(polygon, &across, accept) {
                    joined = true;
                }
            }
            if !joined {
                return;
            }
        }
    }

    /// Merges `polygon` with the first neighbour that allows it, and returns whether there was one.
    fn join_one(
        &mut self,
        polygon: usize,
        across: &impl Fn(u32, DVec3) -> bool,
        accept: &impl Fn(&[DVec3]) -> bool,
    ) -> bool {
        let class = self.classes[polygon];
        for i in 0..self.loops[polygon].len() {
            let (a, b) = edge(&self.loops[polygon], i);
            if !across(class.0, self.positions[b as usize] - self.positions[a as usize]) {
                continue;
            }
            let Some(&neighbour) = self.left_of.get(&(class, b, a)) else { continue };
            if neighbour as usize == polygon {
                continue;
            }
            let union = join(&self.loops[polygon], &self.loops[neighbour as usize], a, b);
            let Some(union) = self.convex(union, self.normals[polygon]) else { continue };
            let corners: Vec<DVec3> = union.iter().map(|&v| self.positions[v as usize]).collect();
            if accept(&corners) {
                self.replace(polygon, neighbour as usize, union);
                return true;
            }
        }
        false
    }

    /// The loop without corners in the middle of an edge, if it is convex.
    fn convex(&self, mut corners: Vec<u32>, normal: DVec3) -> Option<Vec<u32>> {
        let mut i = 0;
        while i < corners.len() && corners.len() > 3 {
            let (p, q, r) = self.around(&corners, i);
            if (q - p).dot(r - q) > 0.0 && distance_to_line(q, p, r) <= self.tolerance {
                corners.remove(i);
                i = i.saturating_sub(1);
            } else {
                i += 1;
            }
        }
        let convex = (0..corners.len()).all(|i| {
            let (p, q, r) = self.around(&corners, i);
            (q - p).cross(r - q).dot(normal) > 0.0
        });
        convex.then_some(corners)
    }

    fn around(&self, corners: &[u32], i: usize) -> (DVec3, DVec3, DVec3) {
        let n = corners.len();
        let at = |k: usize| self.positions[corners[k % n] as usize];
        (at(i + n - 1), at(i), at(i + 1))
    }

    fn replace(&mut self, polygon: usize, neighbour: usize, union: Vec<u32>) {
        self.leave(polygon);
        self.leave(neighbour);
        self.loops[neighbour].clear();
        self.joined.join(polygon, neighbour);
        self.loops[polygon] = union;
        self.enter(polygon);
    }

    fn enter(&mut self, polygon: usize) {
        for i in 0..self.loops[polygon].len() {
            let (a, b) = edge(&self.loops[polygon], i);
            self.left_of.insert((self.classes[polygon], a, b), polygon as u32);
        }
    }

    fn leave(&mut self, polygon: usize) {
        for i in 0..self.loops[polygon].len() {
            let (a, b) = edge(&self.loops[polygon], i);
            self.left_of.remove(&(self.classes[polygon], a, b));
        }
    }

    fn finish(mut self) -> Merged {
        let mut numbers = vec![0; self.loops.len()];
        let mut faces = Vec::new();
        for (polygon, corners) in self.loops.iter().enumerate().filter(|(_, corners)| !corners.is_empty()) {
            numbers[self.joined.root(polygon)] = faces.len() as u32;
            faces.push(Face::new(corners.iter().map(|&v| self.positions[v as usize]).collect()));
        }
        let of = (0..self.loops.len()).map(|polygon| numbers[self.joined.root(polygon)]).collect();
        Merged { faces, of }
    }
}

fn edge(corners: &[u32], i: usize) -> (u32, u32) {
    (corners[i], corners[(i + 1) % corners.len()])
}

/// The loop around both polygons, `left` with the edge a → b and `right` with b → a.
fn join(left: &[u32], right: &[u32], a: u32, b: u32) -> Vec<u32> {
    let from = |corners: &[u32], first: u32| -> Vec<u32> {
        let start = corners.iter().position(|&v| v == first).expect("the edge is on the loop");
        corners[start..].iter().chain(&corners[..start]).copied().collect()
    };
    let mut union = from(left, b);
    let around = from(right, a);
    union.extend_from_slice(&around[1..around.len() - 1]);
    union
}

fn distance_to_line(q: DVec3, p: DVec3, r: DVec3) -> f64 {
    (q - p).cross(r - p).length() / (r - p).length()
}
