//! Divides a geometry into parts by planes, as in the paper: a plane cuts all elements and faces.
//!
//! The cells are convex, so no element of another cell can lie between two points of one cell: the self block of a cell is
//! exact within the whole. Debelov & Sevastyanov, §2.

use crate::elements::clusters;
use crate::geometry::aabb::Aabb;
use crate::geometry::polygon::{Clipped, clip, quads_and_triangles};
use crate::geometry::tolerance::ON_CUT;
use equilux_formats::{Element, Face, FaceId, Geometry};
use glam::DVec3;

/// A plane across one of the coordinate axes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cut {
    /// 0, 1, 2 for x, y, z.
    pub axis: usize,
    /// Position on the axis, metres.
    pub offset: f64,
}

impl std::fmt::Display for Cut {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}={}", ["x", "y", "z"][self.axis], self.offset)
    }
}

impl std::str::FromStr for Cut {
    type Err = String;

    /// Parses `x=1.5`.
    fn from_str(text: &str) -> Result<Self, String> {
        let malformed = || format!("`{text}` is no plane; write an axis and a place on it, such as x=1.5");
        let (axis, offset) = text.split_once('=').ok_or_else(malformed)?;
        let axis = ["x", "y", "z"].iter().position(|&a| a == axis.trim()).ok_or_else(malformed)?;
        let offset: f64 = offset.trim().parse().map_err(|_| malformed())?;
        if offset.is_finite() { Ok(Self { axis, offset }) } else { Err(malformed()) }
    }
}

/// Cuts a geometry into `count` cells: repeatedly halves the cell with the most elements at the median of its longest axis.
pub fn bisect(whole: Geometry, count: usize) -> Vec<Geometry> {
    let mut cells = vec![whole];
    while cells.len() < count {
        let Some(largest) = (0..cells.len()).max_by_key(|&i| (cells[i].elements.len(), cells.len() - i))
        else {
            break;
        };
        let Some(plane) = median(&cells[largest]) else { break };
        let [low, high] = cut(&cells[largest], plane);
        if low.elements.is_empty() || high.elements.is_empty() {
            break;
        }
        cells.splice(largest..=largest, [low, high]);
    }
    cells
}

/// Cuts a geometry by every plane and drops empty cells.
pub fn cut_all(whole: Geometry, planes: &[Cut]) -> Vec<Geometry> {
    let mut cells = vec![whole];
    for &plane in planes {
        cells =
            cells.iter().flat_map(|cell| cut(cell, plane)).filter(|cell| !cell.elements.is_empty()).collect();
    }
    cells
}

/// The plane through the median centroid across the longest axis.
fn median(geometry: &Geometry) -> Option<Cut> {
    let extent = bounds(geometry).size();
    let axis = (0..3).max_by(|&a, &b| extent[a].total_cmp(&extent[b]).then(b.cmp(&a)))?;
    let mut places: Vec<f64> = geometry.elements.iter().map(|e| e.centroid[axis]).collect();
    places.sort_by(f64::total_cmp);
    let offset = places[places.len() / 2];
    // Halfway between two rows of a grid cuts no element.
    let below = places.iter().rev().find(|&&p| p < offset - ON_CUT * extent[axis]).copied();
    Some(Cut { axis, offset: below.map_or(offset, |below| (below + offset) / 2.0) })
}

fn bounds(geometry: &Geometry) -> Aabb {
    Aabb::around(geometry.elements.iter().flat_map(|e| e.corners.as_slice()))
}

/// The parts of a geometry below and above a plane. Elements and faces that cross it are clipped. An element in the
/// plane belongs to the side it faces, and the faces of both sides keep what blocks light there.
pub fn cut(geometry: &Geometry, plane: Cut) -> [Geometry; 2] {
    let tolerance = ON_CUT * bounds(geometry).size().max_element();
    [-1.0, 1.0].map(|side| {
        let height = |p: DVec3| {
            let height = (p[plane.axis] - plane.offset) * side;
            if height.abs() <= tolerance { 0.0 } else { height }
        };
        half(geometry, plane.axis, side, height)
    })
}

fn half(geometry: &Geometry, axis: usize, side: f64, height: impl Fn(DVec3) -> f64) -> Geometry {
    let (mut elements, mut faces) = (vec![], vec![]);
    let mut new_face: Vec<Option<FaceId>> = vec![None; geometry.faces.len()];
    for element in &geometry.elements {
        let corners = element.corners.as_slice();
        let in_plane = corners.iter().all(|&p| height(p) == 0.0);
        let pieces = if in_plane {
            if element.normal[axis] * side > 0.0 { vec![element.corners] } else { vec![] }
        } else {
            match clip(corners, &height) {
                Clipped::All => vec![element.corners],
                Clipped::None => vec![],
                Clipped::Piece(piece) => quads_and_triangles(&piece),
            }
        };
        for piece in pieces {
            let face = *new_face[element.face.index()].get_or_insert_with(|| {
                faces.push(clip_face(&geometry.faces[element.face.index()], &height));
                FaceId::from_index(faces.len() - 1)
            });
            // The normal of the whole element is more accurate than that of a sliver of it.
            let piece = Element::new(piece, element.material, face);
            elements.push(Element { normal: element.normal, ..piece });
        }
    }
    clusters::geometry(elements, faces)
}

fn clip_face(face: &Face, height: impl Fn(DVec3) -> f64) -> Face {
    match clip(&face.corners, height) {
        Clipped::Piece(piece) => Face { corners: piece.to_vec(), normal: face.normal },
        Clipped::All | Clipped::None => face.clone(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use equilux_formats::{Corners, MaterialId};
    use proptest::prelude::*;

    proptest! {
        /// Planes through corners, beside them by rounding, and elsewhere, through triangles of any shape and the
        /// parallelograms that they are halves of.
        #[test]
        fn cells_hold_elements_with_an_area_and_all_of_it(
            triangles in prop::collection::vec((prop::array::uniform3(prop::array::uniform3(-2.0..2.0_f64)), 0.0..1.0_f64), 1..6),
            (axis, corner, is_quad) in (0..3_usize, 0..3_usize, any::<bool>()),
            off in prop_oneof![Just(0.0), -1e-15..1e-15_f64, -1e-8..1e-8_f64, -2.0..2.0_f64],
        ) {
            let elements: Vec<Element> = triangles.iter().enumerate().map(|(number, (corners, flat))| {
                let [a, b, c] = corners.map(DVec3::from_array);
                let c = a.lerp(b, 0.3) + (c - a) * flat.powi(12);
                let corners = if is_quad { Corners::quad([a, b, b + c - a, c]) } else { Corners::triangle([a, b, c]) };
                Element::new(corners, MaterialId(0), FaceId::from_index(number))
            }).collect();
            prop_assume!(elements.iter().all(|e| e.area > 1e-12));
            let faces = elements.iter().map(|e| Face::new(e.corners.as_slice().to_vec())).collect();
            let plane = Cut { axis, offset: triangles[0].0[corner][axis] + off };
            let cells = cut(&clusters::geometry(elements.clone(), faces), plane);
            let mut sum = 0.0;
            for element in cells.iter().flat_map(|cell| &cell.elements) {
                prop_assert!(element.area > 0.0 && element.normal.is_finite() && element.centroid.is_finite(), "{element:?}");
                sum += element.area;
            }
            let whole: f64 = elements.iter().map(|e| e.area).sum();
            // Corners within a billionth of the plane belong to both sides: edges of up to 12 m each have a strip of it.
            prop_assert!((sum - whole).abs() <= 12.0 * 6.0 * 4.0 * ON_CUT * elements.len() as f64, "{sum} of {whole} m²");
        }
    }
}
