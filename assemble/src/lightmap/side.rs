//! The sides of a part's surfaces that can receive light. Input: a part. Output: the fronts of its surfaces, and the
//! backs of double-sided ones.

use equilux_formats::{Corners, MaterialId, Part, Surface};
use glam::{DVec2, DVec3};

/// One side of a surface.
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
    /// Positions of its corners in the author's lightmap, if there is one; the last one of a triangle is repeated.
    pub lightmap: Option<[DVec2; 4]>,
}

impl SurfaceSide {
    /// The front of a surface, whose corners run counter-clockwise around it. The area must be above zero.
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

    /// This side as a surface.
    pub fn surface(&self) -> Surface {
        Surface { lightmap: self.lightmap, ..Surface::new(self.corners, self.material) }
    }
}

/// All sides of `part`: fronts in the order of its surfaces, then backs.
pub fn sides(part: &Part) -> Vec<SurfaceSide> {
    let double = part.surfaces.iter().filter(|surface| part.is_two_sided(surface));
    part.surfaces
        .iter()
        .map(SurfaceSide::of)
        .chain(double.map(|surface| SurfaceSide::of(&surface.flipped())))
        .collect()
}
