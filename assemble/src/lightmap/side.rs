//! The sides of a part's surfaces that can receive light. Input: a part. Output: the fronts of its surfaces, and the
//! backs of double-sided ones.

use crate::receivers::curve::Curve;
use equilux_formats::{Corners, MaterialId, Part, Surface, TexelChoice};
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
    /// Normals of its corners towards this side, where the mesh stands for a smooth surface; a triangle's last is repeated.
    pub normals: Option<[DVec3; 4]>,
    /// The author's choice about its texels.
    pub texels: TexelChoice,
}

impl SurfaceSide {
    /// The front of a surface, whose corners run counter-clockwise around it. The area must be above zero.
    pub fn of(surface: &Surface) -> Self {
        let Surface { corners, material, lightmap, normals, texels, .. } = *surface;
        let double_area = corners.double_area_vector();
        Self {
            corners,
            normal: double_area.normalize(),
            area: double_area.length() / 2.0,
            material,
            lightmap,
            normals,
            texels,
        }
    }

    /// This side as a surface.
    pub fn surface(&self) -> Surface {
        let Self { corners, material, lightmap, normals, texels, .. } = *self;
        Surface { lightmap, normals, texels, ..Surface::new(corners, material) }
    }

    /// The smooth surface for which it stands, if that is not flat.
    pub fn curve(&self) -> Option<Curve> {
        self.normals.map(|normals| Curve::new(self.corners.as_slice(), &normals))
    }

    /// The unit normal of the surface for which it stands, at a point of it.
    pub fn normal_at(&self, point: DVec3) -> DVec3 {
        self.curve().map_or(self.normal, |curve| curve.at(point).normal)
    }
}

/// Whether two sides may share a chart.
pub fn are_alike(a: &SurfaceSide, b: &SurfaceSide) -> bool {
    (a.material, a.texels) == (b.material, b.texels)
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
