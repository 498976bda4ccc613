//! The irradiance of a texel, taken from the element that holds the middle of its footprint. In go the solution's
//! elements and their irradiance; out comes a value a texel, W/m².

use super::texels::{Piece, Texels};
use equilux_bake::visibility::rays::RayIndex;
use equilux_formats::{Element, Rgb};
use glam::DVec3;

/// How far before a surface its element is looked for, of the scene's extent: more than rounding, less than things are
/// apart.
const BEFORE: f64 = 1e-6;

/// Looks up elements.
pub struct Nearest<'a> {
    index: RayIndex<'a>,
    irradiance: &'a [Rgb],
    before: f64,
}

impl<'a> Nearest<'a> {
    /// Looks among `elements`; `irradiance`: W/m², one row an element.
    pub fn new(elements: &'a [Element], irradiance: &'a [Rgb]) -> Self {
        let corners = elements.iter().flat_map(|element| element.corners.as_slice());
        let before = BEFORE * corners.map(|p| p.abs().max_element()).fold(0.0, f64::max);
        Self { index: RayIndex::new(elements), irradiance, before }
    }

    /// One value a texel; black where there is no element.
    pub fn irradiance(&self, texels: &Texels) -> Vec<Rgb> {
        let largest = |pieces: &[Piece]| {
            let by_area = |a: &&Piece, b: &&Piece| a.area.total_cmp(&b.area);
            pieces.iter().max_by(by_area).map_or([0.0; 3], |piece| self.at(piece))
        };
        texels.texels.iter().map(|texel| largest(&texel.pieces)).collect()
    }

    fn at(&self, piece: &Piece) -> Rgb {
        let middle = piece.corners.iter().sum::<DVec3>() / piece.corners.len() as f64;
        let hit = self.index.first_front(middle + piece.normal * self.before, -piece.normal);
        hit.map_or([0.0; 3], |hit| self.irradiance[hit.element])
    }
}
