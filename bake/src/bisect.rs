//! Parts by planes, as the paper makes them: a plane cuts all elements and faces into what lies on either side.
//!
//! The cells are convex, so nothing foreign can stand between two points of one of them: a cell's own block of form
//! factors is exact inside the whole. Debelov & Sevastyanov, §2.

use crate::clusters;
use crate::form_factor::polygon::{Side, clip};
use equilux_formats::{Corners, Element, Face, FaceId, Geometry};
use glam::DVec3;

/// A plane across one of the coordinate axes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cut {
    /// 0, 1, 2 for x, y, z.
    pub axis: usize,
    /// Where on the axis, metres.
    pub offset: f64,
}

impl std::fmt::Display for Cut {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}={}", ["x", "y", "z"][self.axis], self.offset)
    }
}

impl std::str::FromStr for Cut {
    type Err = String;

    /// Reads `x=1.5`.
    fn from_str(text: &str) -> Result<Self, String> {
        let malformed = || format!("`{text}` is no plane; write an axis and a place on it, such as x=1.5");
        let (axis, offset) = text.split_once('=').ok_or_else(malformed)?;
        let axis = ["x", "y", "z"].iter().position(|&a| a == axis.trim()).ok_or_else(malformed)?;
        let offset: f64 = offset.trim().parse().map_err(|_| malformed())?;
        if offset.is_finite() { Ok(Self { axis, offset }) } else { Err(malformed()) }
    }
}

/// How far from the plane, relative to the geometry's extent, a corner still counts as on it: no slivers are made
/// where a plane follows an edge.
const ON_PLANE: f64 = 1e-9;

/// Cut into `count` cells, each time the cell with the most elements at the median of its longest axis.
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

/// Cut every cell by every plane; empty cells are left out.
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
    let (low, high) = bounds(geometry);
    let extent = high - low;
    let axis = (0..3).max_by(|&a, &b| extent[a].total_cmp(&extent[b]).then(b.cmp(&a)))?;
    let mut places: Vec<f64> = geometry.elements.iter().map(|e| e.centroid[axis]).collect();
    places.sort_by(f64::total_cmp);
    let offset = places[places.len() / 2];
    // Halfway between two rows of a grid cuts no element.
    let below = places.iter().rev().find(|&&p| p < offset - ON_PLANE * extent[axis]).copied();
    Some(Cut { axis, offset: below.map_or(offset, |below| (below + offset) / 2.0) })
}

fn bounds(geometry: &Geometry) -> (DVec3, DVec3) {
    let corners = geometry.elements.iter().flat_map(|e| e.corners.as_slice());
    corners.fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(low, high), &p| (low.min(p), high.max(p)))
}

/// What lies below and above the plane. Elements and faces across it are clipped; an element in the plane goes to the
/// side it looks at, and the faces of both sides keep what blocks light there.
pub fn cut(geometry: &Geometry, plane: Cut) -> [Geometry; 2] {
    let (low, high) = bounds(geometry);
    let tolerance = ON_PLANE * (high - low).max_element();
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
                Side::All => vec![element.corners],
                Side::None => vec![],
                Side::Piece(piece) => split_into_corners(&piece),
            }
        };
        for piece in pieces {
            let face = *new_face[element.face.index()].get_or_insert_with(|| {
                faces.push(clip_face(&geometry.faces[element.face.index()], &height));
                FaceId::from_index(faces.len() - 1)
            });
            elements.push(Element::new(piece, element.material, face));
        }
    }
    clusters::geometry(elements, faces)
}

fn clip_face(face: &Face, height: impl Fn(DVec3) -> f64) -> Face {
    match clip(&face.corners, height) {
        Side::Piece(piece) => Face::new(piece.to_vec()),
        Side::All | Side::None => face.clone(),
    }
}

/// Three to five corners as elements of at most four.
fn split_into_corners(piece: &[DVec3]) -> Vec<Corners> {
    match *piece {
        [a, b, c] => vec![Corners::triangle([a, b, c])],
        [a, b, c, d] => vec![Corners::quad([a, b, c, d])],
        [a, b, c, d, e] => vec![Corners::quad([a, b, c, d]), Corners::triangle([a, d, e])],
        _ => unreachable!("a plane cuts at most one corner off a quad, leaving five, not {}", piece.len()),
    }
}
