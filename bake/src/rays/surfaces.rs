//! A part for rays: its faces in a tree, and the unknown at each place on them.

use super::element_grid::ElementGrid;
use super::face_tree::{FaceHit, FaceTree};
use super::hemisphere::Emitters;
use super::wide_tree::Ray;
use crate::geometry::polygon::area;
use crate::geometry::solids::solids;
use equilux_formats::{Element, Face, Geometry};

/// What a ray ends on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum End {
    /// The element of this number in its part.
    Element(u32),
    /// The inside of something that covers the start of the ray: a closed solid, or a black back nearer than the unknown is
    /// wide.
    Covered,
    /// A side without elements, which is black.
    Black,
}

/// The faces of a part with their elements.
#[derive(Debug)]
pub struct Surfaces {
    /// The faces, in a tree.
    pub tree: FaceTree,
    /// The elements on the front and on the back of each face.
    sides: Vec<[Option<ElementGrid>; 2]>,
    /// Whether a face belongs to a closed solid.
    of_solid: Vec<bool>,
    elements: Vec<Element>,
    /// The unknown of each element.
    unknown_of: Vec<u32>,
    /// The area of each unknown.
    emitters: Vec<Emitters>,
}

impl Surfaces {
    /// The surfaces of a part. Without patches every element is an unknown.
    pub fn new(geometry: &Geometry) -> Self {
        let Geometry { elements, faces, patches, .. } = geometry;
        let unknown_of = patches.as_ref().map(|patches| patches.of.clone());
        let unknown_of = unknown_of.unwrap_or_else(|| (0..elements.len() as u32).collect());
        let mut on: Vec<[Vec<u32>; 2]> = vec![[vec![], vec![]]; faces.len()];
        for (number, element) in elements.iter().enumerate() {
            let face = element.face.index();
            let side = usize::from(element.normal.dot(faces[face].normal) < 0.0);
            on[face][side].push(number as u32);
        }
        let grid = |own: Vec<u32>, area| (!own.is_empty()).then(|| ElementGrid::new(&own, elements, area));
        let sides = faces.iter().zip(on).map(|(face, on)| on.map(|own| grid(own, area(&face.corners))));
        let mut of_solid = vec![false; faces.len()];
        solids(geometry)
            .iter()
            .flat_map(|solid| &solid.faces)
            .for_each(|&face| of_solid[face as usize] = true);
        Self {
            tree: FaceTree::new(faces),
            sides: sides.collect(),
            of_solid,
            emitters: emitters(geometry, &unknown_of),
            elements: elements.clone(),
            unknown_of,
        }
    }

    /// The area of an unknown.
    #[inline(always)]
    pub fn emitters(&self, unknown: usize) -> &Emitters {
        &self.emitters[unknown]
    }

    /// The unknown of an element.
    #[inline(always)]
    pub fn unknown_of(&self, element: u32) -> u32 {
        self.unknown_of[element as usize]
    }

    /// Number of unknowns.
    pub fn unknowns(&self) -> usize {
        self.emitters.len()
    }

    /// What a ray ends on where it meets a face. `near`: the t up to which a black back covers its start.
    #[inline(always)]
    pub fn end(&self, ray: &Ray, hit: &FaceHit, near: f64) -> End {
        let face = hit.face as usize;
        let grid = &self.sides[face][usize::from(!hit.front)];
        match grid.as_ref().and_then(|grid| grid.at(ray.at(hit.t), &self.elements)) {
            Some(element) => End::Element(element),
            None if !hit.front && (self.of_solid[face] || hit.t <= near) => End::Covered,
            None => End::Black,
        }
    }
}

/// The area of each unknown.
fn emitters(Geometry { elements, faces, .. }: &Geometry, unknown_of: &[u32]) -> Vec<Emitters> {
    let count = unknown_of.iter().max().map_or(0, |&last| last as usize + 1);
    let mut of: Vec<Vec<(&Element, &Face)>> = vec![vec![]; count];
    for (&unknown, element) in unknown_of.iter().zip(elements) {
        of[unknown as usize].push((element, &faces[element.face.index()]));
    }
    of.into_iter().map(Emitters::on).collect()
}
