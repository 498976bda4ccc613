//! Elements inside closed solids, which are usually unintended. Input: placed parts. Output: notes for the report.
//!
//! Bounding boxes exclude most elements. An element is inside a solid if its centroid lies inside by more than a
//! small share of its size, so that touching does not count, and if most rays from it meet backs of the solid's
//! instance. Objects in a room inside a building's shell lie inside the shell too, but see the room.

use crate::placed_parts::PlacedParts;
use equilux_bake::geometry::aabb::Aabb;
use equilux_bake::geometry::solids::{Solid, solids};
use equilux_bake::rays::RayIndex;
use equilux_bake::world::World;
use equilux_formats::{Element, Geometry, Instance};
use glam::DAffine3;
use std::collections::BTreeMap;

/// An element counts as inside when its centroid lies deeper than this share of its size.
const MIN_DEPTH_SHARE: f64 = 1e-2;

/// Number of elements and pairs of parts that are named; the rest are counted.
const MAX_NAMED: usize = 3;

/// Notes on the first few pairs of instances of which one has elements inside a solid of the other.
pub fn notes(placed: &PlacedParts) -> Vec<String> {
    let parts: Vec<&Geometry> = placed.parts.iter().map(|part| &part.part.geometry).collect();
    sentences(&elements_inside(&placed.world, &placed.instances, &parts), &placed.instances)
}

/// Elements inside a solid, as element numbers of the scene, by instance and instance of the solid.
pub type ElementsInside = BTreeMap<[usize; 2], Vec<usize>>;

/// A note on each of the first few pairs of instances.
pub fn sentences(inside: &ElementsInside, instances: &[Instance]) -> Vec<String> {
    let name = |k: usize| format!("`{}`", instances[k].name);
    let sentence = |(&[own, other], elements): (&[usize; 2], &Vec<usize>)| {
        let named: Vec<String> = elements.iter().take(MAX_NAMED).map(usize::to_string).collect();
        let more = if elements.len() > MAX_NAMED { ", …" } else { "" };
        let (count, whose) = (elements.len(), if own == other { "itself".into() } else { name(other) });
        let (plural, lie) = if count == 1 { ("", "lies") } else { ("s", "lie") };
        format!(
            "{count} element{plural} of {} {lie} inside a solid of {whose}: {}{more}; move it out, or remove the hidden surfaces",
            name(own),
            named.join(", ")
        )
    };
    let mut notes: Vec<String> = inside.iter().take(MAX_NAMED).map(sentence).collect();
    if inside.len() > MAX_NAMED {
        notes.push(format!("{} more pairs of parts reach into each other", inside.len() - MAX_NAMED));
    }
    notes
}

/// The elements of a world that lie inside solids. `parts`: the geometries of the instances' parts.
pub fn elements_inside(world: &World, instances: &[Instance], parts: &[&Geometry]) -> ElementsInside {
    let solids: Vec<Vec<Solid>> = parts.iter().map(|part| solids(part)).collect();
    let mut inside = ElementsInside::new();
    let mut index = None;
    for (other, instance) in instances.iter().enumerate() {
        let (geometry, of_part) = (parts[instance.part.index()], &solids[instance.part.index()]);
        if of_part.is_empty() {
            continue;
        }
        let to_part = instance.placement.inverse();
        for own in 0..instances.len() {
            let mut found = SolidSearch { world, own, other, geometry, to_part }.elements(of_part);
            if !found.is_empty() {
                let index = index.get_or_insert_with(|| RayIndex::new(&world.elements));
                found.retain(|&element| sees_backs(world, index, element, other));
            }
            if !found.is_empty() {
                inside.insert([own, other], found);
            }
        }
    }
    inside
}

struct SolidSearch<'a> {
    world: &'a World,
    own: usize,
    other: usize,
    /// The geometry of `other`.
    geometry: &'a Geometry,
    to_part: DAffine3,
}

impl SolidSearch<'_> {
    /// The elements of `own` inside any of the solids of `other`.
    fn elements(&self, solids: &[Solid]) -> Vec<usize> {
        let Some(root) = self.world.root_of(self.own) else { return vec![] };
        let node = &self.world.nodes[root];
        let near: Vec<&Solid> =
            solids.iter().filter(|solid| overlaps(solid, &node.bounds, self.to_part)).collect();
        let elements = self.world.elements_of(self.own);
        elements.filter(|&number| near.iter().any(|solid| self.is_inside(number, solid))).collect()
    }

    fn is_inside(&self, number: usize, solid: &Solid) -> bool {
        let element = &self.world.elements[number];
        if self.own == self.other && solid.faces.binary_search(&self.face_in_part(element)).is_ok() {
            return false;
        }
        // Areas scale with the square of lengths.
        let scale = self.to_part.matrix3.determinant().abs().cbrt();
        let depth = MIN_DEPTH_SHARE * element.area.sqrt() * scale;
        solid.holds(self.to_part.transform_point3(element.centroid), depth, &self.geometry.faces)
    }

    /// The face number, within the part, of an element of `other`.
    fn face_in_part(&self, element: &Element) -> u32 {
        let first = self.world.elements[self.world.elements_of(self.other).start].face.0;
        element.face.0 - (first - self.geometry.elements[0].face.0)
    }
}

/// Whether the bounding box of a solid can meet `bounds`, a box in scene coordinates.
fn overlaps(solid: &Solid, bounds: &Aabb, to_part: DAffine3) -> bool {
    let centre = to_part.transform_point3(bounds.centre());
    let half = bounds.size() / 2.0;
    let reach = to_part.matrix3.x_axis.abs() * half.x
        + to_part.matrix3.y_axis.abs() * half.y
        + to_part.matrix3.z_axis.abs() * half.z;
    (centre - reach).cmple(solid.bounds.high).all() && (centre + reach).cmpge(solid.bounds.low).all()
}

/// Ray directions from an element, along the normal and tilted to four sides: coefficients of the normal and two
/// tangents.
const DIRECTIONS: [[f64; 3]; 5] =
    [[1.0, 0.013, 0.029], [0.7, 0.6, 0.1], [0.7, -0.1, 0.6], [0.7, -0.6, -0.1], [0.7, 0.1, -0.6]];

/// Whether most rays from an element meet backs of the instance `other`.
fn sees_backs(world: &World, index: &RayIndex, number: usize, other: usize) -> bool {
    let element = &world.elements[number];
    let corners = element.corners.as_slice();
    let along = (corners[1] - corners[0]).normalize();
    let across = element.normal.cross(along);
    let start = element.centroid + element.normal * (1e-9 * element.area.sqrt());
    let is_back = |[n, u, v]: &[f64; 3]| {
        let hit = index.first_hit(start, element.normal * *n + along * *u + across * *v);
        hit.is_some_and(|hit| !hit.front && world.elements_of(other).contains(&hit.element))
    };
    2 * DIRECTIONS.iter().filter(|direction| is_back(direction)).count() > DIRECTIONS.len()
}
