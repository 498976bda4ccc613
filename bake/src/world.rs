//! Elements and faces of one or many instances in one frame: what form-factor rows are computed in.

use crate::planes;
use crate::visibility::FaceIndex;
use equilux_formats::{Element, Face, FaceId, Geometry};
use glam::DAffine3;
use std::ops::Range;

/// Placed geometry with what finds its way through it.
pub struct World {
    /// All elements, instance after instance; `face` counts through [`World::faces`].
    pub elements: Vec<Element>,
    /// All faces: everything that blocks light.
    pub faces: Vec<Face>,
    /// The plane that each face lies in.
    pub planes: Vec<u32>,
    /// Runs of elements that lie in the same face and look the same way.
    pub groups: Vec<Range<usize>>,
    /// Finds faces by place.
    pub index: FaceIndex,
    /// The elements of each instance.
    instances: Vec<Range<usize>>,
}

impl World {
    /// The world of geometries, each moved by its placement (a similarity).
    pub fn new<'a>(placed: impl IntoIterator<Item = (&'a Geometry, DAffine3)>) -> Self {
        let (mut elements, mut faces, mut instances) = (Vec::new(), Vec::new(), Vec::new());
        for (geometry, placement) in placed {
            let (first_element, first_face) = (elements.len(), faces.len() as u32);
            elements.extend(geometry.elements.iter().map(|e| place_element(e, placement, first_face)));
            faces.extend(geometry.faces.iter().map(|face| place_face(face, placement)));
            instances.push(first_element..elements.len());
        }
        let planes = planes::group(&faces);
        let groups = groups(&elements, &instances);
        let index = FaceIndex::new(&faces);
        Self { elements, faces, planes, groups, index, instances }
    }

    /// The elements of the `instance`-th geometry.
    pub fn elements_of(&self, instance: usize) -> Range<usize> {
        self.instances[instance].clone()
    }

    /// Number of geometries.
    pub fn instances(&self) -> usize {
        self.instances.len()
    }
}

/// A mirrored placement turns the order of the corners around, so that they stay counter-clockwise from the front.
fn place_element(element: &Element, placement: DAffine3, first_face: u32) -> Element {
    if placement == DAffine3::IDENTITY {
        return Element { face: FaceId(element.face.0 + first_face), ..*element };
    }
    let mut corners = element.corners.map(|p| placement.transform_point3(p));
    if placement.matrix3.determinant() < 0.0 {
        corners = corners.flipped();
    }
    Element::new(corners, element.material, FaceId(element.face.0 + first_face))
}

fn place_face(face: &Face, placement: DAffine3) -> Face {
    if placement == DAffine3::IDENTITY {
        return face.clone();
    }
    Face::new(face.corners.iter().map(|&p| placement.transform_point3(p)).collect())
}

fn groups(elements: &[Element], instances: &[Range<usize>]) -> Vec<Range<usize>> {
    let mut groups = Vec::new();
    for instance in instances {
        let mut start = instance.start;
        for next in instance.clone().skip(1).chain([instance.end]) {
            if next == instance.end || !same_side(&elements[start], &elements[next]) {
                groups.push(start..next);
                start = next;
            }
        }
    }
    groups.retain(|group| !group.is_empty());
    groups
}

fn same_side(a: &Element, b: &Element) -> bool {
    a.face == b.face && a.normal.dot(b.normal) > 0.0
}
