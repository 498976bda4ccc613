//! The sides of a part's surfaces that light can fall on. In goes a part; out come its surfaces, and once more, seen
//! from behind, those that are double-sided.

use equilux_formats::{Corners, MaterialId, Part, Surface};
use glam::{DVec2, DVec3};

/// A surface seen from the side that is lit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SurfaceSide {
    /// Corners, counter-clockwise seen from this side, metres.
    pub corners: Corners,
    /// Unit normal of this side.
    pub normal: DVec3,
    /// Area, m².
    pub area: f64,
    /// Its material.
    pub material: MaterialId,
    /// Where its corners lie in the author's lightmap, if there is one; a triangle's last comes twice.
    pub lightmap: Option<[DVec2; 4]>,
}

impl SurfaceSide {
    /// The side of a surface that its corners run around counter-clockwise. The area must be above zero.
    pub fn of(surface: &Surface) -> Self {
        let Surface { corners, material, lightmap, .. } = *surface;
        let double_area = corners.double_area_vector();
        Self {
            corners,
            normal: double_area.normalize(),
            area: double_area.length() / 2.0,
            material,
            lightmap,
        }
    }

    /// It as a surface.
    pub fn surface(&self) -> Surface {
        Surface { lightmap: self.lightmap, ..Surface::new(self.corners, self.material) }
    }
}

/// All sides of `part`, fronts in the order of its surfaces, then backs.
pub fn sides(part: &Part) -> Vec<SurfaceSide> {
    let double = part.surfaces.iter().filter(|surface| part.is_two_sided(surface));
    part.surfaces
        .iter()
        .map(SurfaceSide::of)
        .chain(double.map(|surface| SurfaceSide::of(&surface.flipped())))
        .collect()
}
