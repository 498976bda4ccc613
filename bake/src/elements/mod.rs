//! Cuts surfaces into elements: quads and triangles of at most a given size.

pub mod bisect;
pub mod clusters;
pub mod cuts;
pub mod merge;
pub mod patches;

use crate::geometry::tolerance::FLATNESS;
use equilux_formats::{
    Corners, Element, Face, FaceId, Geometry, Material, MaterialId, Optics, Part, Repainted, Surface, Tints,
};
use glam::DVec3;
use merge::{Merged, merge};
use serde::{Deserialize, Serialize};

/// The largest size of elements.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub enum ElementSize {
    /// No edge longer than this, metres.
    Metres(f64),
    /// The mesh's own faces; two triangles that form a parallelogram are one.
    Mesh,
}

impl ElementSize {
    /// The same size in a unit of length that is `metres` long.
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

/// About the number of elements of a scene by default: enough to show shadows after seconds of work.
const DEFAULT_ELEMENTS: f64 = 3000.0;

/// A size that suits surfaces of this total area (m²): a round number that gives a few thousand elements.
pub fn default_size(area: f64) -> ElementSize {
    // Rounded up by more than scales in f32 are off, so that equal scenes get the same size.
    let wanted = (area / DEFAULT_ELEMENTS).sqrt() * (1.0 + 1e-6);
    let decade = 10f64.powf(wanted.log10().floor());
    let step = [5.0, 2.5, 2.0, 1.5, 1.0].into_iter().find(|s| s * decade <= wanted).unwrap_or(1.0);
    // Formatted and parsed again, so that the printed size is the size used.
    ElementSize::Metres(format!("{:.3e}", step * decade).parse().unwrap_or(wanted))
}

/// Total area of a part's surfaces, both sides of two-sided ones, m².
pub fn area(part: &Part) -> f64 {
    let sides = |s: &Surface| if part.is_two_sided(s) { 2.0 } else { 1.0 };
    part.surfaces.iter().map(|s| s.corners.double_area_vector().length() / 2.0 * sides(s)).sum()
}

/// The part's elements and faces, in the order of the elements' hierarchy.
pub fn subdivide(part: &Part, size: ElementSize) -> Geometry {
    Panels::of(part, size).geometry()
}

/// A part's surfaces, ready to be cut into elements.
#[derive(Debug)]
pub struct Panels {
    size: ElementSize,
    panels: Vec<Panel>,
}

/// A triangle or quad of one material that is cut as a whole.
#[derive(Debug, Clone, Copy)]
struct Panel {
    corners: Corners,
    material: MaterialId,
    two_sided: bool,
}

impl Panels {
    /// The panels of `part`, for elements of `size` in the part's own unit. With [`ElementSize::Mesh`] they are the
    /// surfaces themselves; otherwise adjacent parallelograms are merged, so that elements follow the wall and not its
    /// tessellation.
    pub fn of(part: &Part, size: ElementSize) -> Self {
        let panel =
            |s: &Surface| Panel { corners: s.corners, material: s.material, two_sided: part.is_two_sided(s) };
        let own = part.surfaces.iter().map(panel);
        let panels = match size {
            ElementSize::Mesh => own.collect(),
            ElementSize::Metres(_) => joined(own),
        };
        Self { size, panels }
    }

    /// The number of elements.
    pub fn elements(&self) -> u128 {
        let pieces = |panel: &Panel| match self.size {
            ElementSize::Metres(size) => cuts::count(&panel.corners, size),
            ElementSize::Mesh => 1,
        };
        let of_panel = |panel| pieces(panel).saturating_mul(panel.sides() as u128);
        self.panels.iter().map(of_panel).fold(0, u128::saturating_add)
    }

    /// The elements and faces, in the order of the elements' hierarchy.
    pub fn geometry(&self) -> Geometry {
        let polygons: Vec<Face> = self.panels.iter().map(|panel| polygon(&panel.corners)).collect();
        let Merged { faces, of } = merge(&polygons, |_| (), |_| true);
        let sides = |index: usize| (0..self.panels[index].sides()).map(move |side| (side, index));
        let mut order: Vec<(u32, usize, usize)> =
            (0..self.panels.len()).flat_map(sides).map(|(side, index)| (of[index], side, index)).collect();
        order.sort_unstable();
        let mut elements = Vec::new();
        for (face, side, index) in order {
            let Panel { corners, material, .. } = self.panels[index];
            let emit = |piece: Corners| {
                let corners = if side == 0 { piece } else { piece.flipped() };
                elements.push(Element::new(corners, material, FaceId(face)));
            };
            match self.size {
                ElementSize::Metres(size) => cuts::cut(&corners, size, emit),
                ElementSize::Mesh => std::iter::once(corners).for_each(emit),
            }
        }
        clusters::geometry(elements, faces)
    }
}

impl Panel {
    /// The number of sides with elements: 1 (front) or 2.
    fn sides(&self) -> usize {
        if self.two_sided { 2 } else { 1 }
    }
}

/// Reflectance and emission, one row an element: those of the material times `tints`.
pub fn optics(geometry: &Geometry, materials: &[Material], tints: &Tints) -> Optics {
    let of = |element: &Element| &materials[element.material.index()];
    let (reflectance, emission) = (tints.reflectance.iter(), tints.emission.iter());
    let elements = || geometry.elements.iter().map(of);
    Optics {
        reflectance: elements().zip(reflectance).map(|(m, &tint)| m.reflectance * tint).collect(),
        emission: elements().zip(emission).map(|(m, &tint)| m.emission * tint).collect(),
    }
}

/// `optics` after some materials were repainted. `tints` multiply the new colours too.
pub fn repainted(geometry: &Geometry, optics: &Optics, tints: &Tints, repainted: &[Repainted]) -> Optics {
    let mut here = optics.clone();
    for (i, element) in geometry.elements.iter().enumerate() {
        if let Some(new) = repainted.iter().find(|new| new.material == element.material) {
            here.reflectance[i] = new.reflectance * tints.reflectance[i];
            here.emission[i] = new.emission * tints.emission[i];
        }
    }
    here
}

/// Merges adjacent parallelograms of one material.
fn joined(panels: impl Iterator<Item = Panel>) -> Vec<Panel> {
    let (quads, mut panels): (Vec<Panel>, Vec<Panel>) = panels.partition(|p| p.corners.as_slice().len() == 4);
    let polygons: Vec<Face> = quads.iter().map(|panel| polygon(&panel.corners)).collect();
    let Merged { faces, of } =
        merge(&polygons, |i| (quads[i].material.0, quads[i].two_sided), is_parallelogram);
    let mut quad_of = vec![0; faces.len()];
    for (quad, &face) in of.iter().enumerate() {
        quad_of[face as usize] = quad;
    }
    panels.extend(faces.iter().zip(quad_of).map(|(face, quad)| {
        let c = &face.corners;
        Panel { corners: Corners::quad([c[0], c[1], c[2], c[3]]), ..quads[quad] }
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
