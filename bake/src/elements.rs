//! Surfaces → elements: every surface is cut into near-square quads or triangles no larger than asked for.

use crate::clusters;
use crate::merge::{Merged, merge};
use crate::planes::FLATNESS;
use equilux_formats::{
    Corners, Element, Face, FaceId, Geometry, Material, MaterialId, Optics, Part, Repainted, Rgb, Tints,
};
use glam::DVec3;
use serde::{Deserialize, Serialize};

/// How large elements may be.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub enum ElementSize {
    /// No edge longer than this, metres.
    Metres(f64),
    /// The mesh's own faces; two triangles that form a parallelogram are one.
    Mesh,
}

impl ElementSize {
    /// The same size in units of which each is so many metres.
    pub fn in_units_of(self, metres: f64) -> Self {
        match self {
            Self::Metres(size) => Self::Metres(size / metres),
            Self::Mesh => Self::Mesh,
        }
    }
}

impl std::fmt::Display for ElementSize {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Metres(size) => write!(f, "{size} m"),
            Self::Mesh => write!(f, "mesh"),
        }
    }
}

/// About this many elements a scene gets when nobody says otherwise: seconds of work, and shadows one can see.
const DEFAULT_ELEMENTS: f64 = 3000.0;

/// A size that suits surfaces of this total area (m²): a round number that gives a few thousand elements.
pub fn default_size(area: f64) -> ElementSize {
    // Above what rounding takes from it, such as scales in f32 do: scenes that are the same get the same size.
    let wanted = (area / DEFAULT_ELEMENTS).sqrt() * (1.0 + 1e-6);
    let decade = 10f64.powf(wanted.log10().floor());
    let step = [5.0, 2.5, 2.0, 1.5, 1.0].into_iter().find(|s| s * decade <= wanted).unwrap_or(1.0);
    // Written out and read again, so that the size printed is the size used.
    ElementSize::Metres(format!("{:.3e}", step * decade).parse().unwrap_or(wanted))
}

/// Total area of a part's surfaces, both sides of two-sided ones, m².
pub fn area(part: &Part) -> f64 {
    let sides = |s: MaterialId| if part.materials[s.index()].double_sided { 2.0 } else { 1.0 };
    part.surfaces.iter().map(|s| s.corners.double_area_vector().length() / 2.0 * sides(s.material)).sum()
}

/// The part's elements and faces, in the order of the elements' hierarchy.
pub fn subdivide(part: &Part, size: ElementSize) -> Geometry {
    let panels = panels(part, size);
    let polygons: Vec<Face> = panels.iter().map(|panel| polygon(&panel.corners)).collect();
    let Merged { faces, of } = merge(&polygons, |_| 0, |_| true);

    let mut order: Vec<(u32, bool, usize)> = Vec::new();
    for (index, panel) in panels.iter().enumerate() {
        order.push((of[index], false, index));
        if part.materials[panel.material.index()].double_sided {
            order.push((of[index], true, index));
        }
    }
    order.sort_unstable();
    let mut elements = Vec::new();
    for (face, back, index) in order {
        let Panel { corners, material } = panels[index];
        cut_up(&corners, size, |piece| {
            let corners = if back { piece.flipped() } else { piece };
            elements.push(Element::new(corners, material, FaceId(face)));
        });
    }
    clusters::geometry(elements, faces)
}

/// Reflectance and emission of every element.
pub fn optics(geometry: &Geometry, materials: &[Material], tints: &Tints) -> Optics {
    let of = |element: &Element| &materials[element.material.index()];
    let (reflectance, emission) = (tints.reflectance.iter(), tints.emission.iter());
    let elements = || geometry.elements.iter().map(of);
    Optics {
        reflectance: elements().zip(reflectance).map(|(m, &tint)| tinted(m.reflectance, tint)).collect(),
        emission: elements().zip(emission).map(|(m, &tint)| tinted(m.emission, tint)).collect(),
    }
}

/// The same where some of the materials look otherwise: textures go on multiplying the new colours.
pub fn repainted(geometry: &Geometry, optics: &Optics, tints: &Tints, repainted: &[Repainted]) -> Optics {
    let mut here = optics.clone();
    for (i, element) in geometry.elements.iter().enumerate() {
        if let Some(new) = repainted.iter().find(|new| new.material == element.material) {
            here.reflectance[i] = tinted(new.reflectance, tints.reflectance[i]);
            here.emission[i] = tinted(new.emission, tints.emission[i]);
        }
    }
    here
}

fn tinted(colour: Rgb, tint: Rgb) -> Rgb {
    std::array::from_fn(|c| colour[c] * tint[c])
}

/// A triangle or parallelogram of one material that is cut up as a whole.
#[derive(Clone, Copy)]
struct Panel {
    corners: Corners,
    material: MaterialId,
}

/// The surfaces themselves, or, where elements have their own size, parallelograms joined to larger ones, so that
/// elements follow the wall and not the tessellation somebody happened to give it.
fn panels(part: &Part, size: ElementSize) -> Vec<Panel> {
    let own = part.surfaces.iter().map(|s| Panel { corners: s.corners, material: s.material });
    if size == ElementSize::Mesh {
        return own.collect();
    }
    let (quads, mut panels): (Vec<Panel>, Vec<Panel>) = own.partition(|p| p.corners.as_slice().len() == 4);
    let polygons: Vec<Face> = quads.iter().map(|panel| polygon(&panel.corners)).collect();
    let Merged { faces, of } = merge(&polygons, |i| quads[i].material.0, is_parallelogram);
    let mut material = vec![MaterialId(0); faces.len()];
    for (quad, &face) in quads.iter().zip(&of) {
        material[face as usize] = quad.material;
    }
    panels.extend(faces.iter().zip(material).map(|(face, material)| {
        let c = &face.corners;
        Panel { corners: Corners::quad([c[0], c[1], c[2], c[3]]), material }
    }));
    panels
}

fn polygon(corners: &Corners) -> Face {
    Face::new(corners.as_slice().to_vec())
}

fn is_parallelogram(corners: &[DVec3]) -> bool {
    let &[a, b, c, d] = corners else { return false };
    let reach = corners.iter().map(|p| p.abs().max_element()).fold(0.0, f64::max);
    ((a + c) - (b + d)).length() <= 2.0 * FLATNESS * reach
}

fn cut_up(corners: &Corners, size: ElementSize, emit: impl FnMut(Corners)) {
    let ElementSize::Metres(size) = size else { return std::iter::once(*corners).for_each(emit) };
    match *corners.as_slice() {
        [a, b, c] => cut_triangle([a, b, c], size, emit),
        [a, b, c, d] => cut_quad([a, b, c, d], size, emit),
        _ => unreachable!("a surface has three or four corners"),
    }
}

/// How many pieces an edge needs; an edge that is longer by rounding only does not need another.
fn pieces(length: f64, size: f64) -> usize {
    ((length / size) * (1.0 - 1e-6)).ceil().max(1.0) as usize
}

/// The i-th of n equal steps from a to b. Exact at both ends, and exactly on a coordinate plane that both ends lie on.
fn step(a: DVec3, b: DVec3, i: usize, n: usize) -> DVec3 {
    if i == n { b } else { a + (b - a) * (i as f64 / n as f64) }
}

/// A grid whose pieces share corners to the bit.
fn cut_quad([a, b, c, d]: [DVec3; 4], size: f64, mut emit: impl FnMut(Corners)) {
    let across = pieces((b - a).length().max((c - d).length()), size);
    let along = pieces((d - a).length().max((c - b).length()), size);
    let at = |i, j| step(step(a, b, i, across), step(d, c, i, across), j, along);
    for j in 0..along {
        for i in 0..across {
            emit(Corners::quad([at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)]));
        }
    }
}

/// n² triangles similar to the whole.
fn cut_triangle([a, b, c]: [DVec3; 3], size: f64, mut emit: impl FnMut(Corners)) {
    let longest = (b - a).length().max((c - b).length()).max((a - c).length());
    let n = pieces(longest, size);
    let at = |i: usize, j: usize| step(step(a, c, j, n), step(b, c, j, n), i, (n - j).max(1));
    for j in 0..n {
        for i in 0..n - j {
            emit(Corners::triangle([at(i, j), at(i + 1, j), at(i, j + 1)]));
            if i + j + 1 < n {
                emit(Corners::triangle([at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)]));
            }
        }
    }
}
