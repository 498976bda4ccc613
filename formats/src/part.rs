//! Parts before baking: flat convex surfaces with materials, in the part's own coordinates.

use crate::geometry::Corners;
use crate::ids::MaterialId;
use crate::rgb::Rgb;
use crate::texture::{TexturedTriangle, Textures};
use glam::{DAffine3, DVec2};
use serde::{Deserialize, Serialize};

/// A unit that is baked once and placed many times. The importer guarantees: every coordinate is finite, every surface is
/// planar and convex with an area above zero, no two surfaces coincide with the same orientation, and every material
/// id is valid.
#[derive(Debug, Clone, PartialEq)]
pub struct Part {
    /// The root node's name, or the file's stem.
    pub name: String,
    /// The surfaces, metres, relative to the part's origin.
    pub surfaces: Vec<Surface>,
    /// The materials that the surfaces name.
    pub materials: Vec<Material>,
    /// The triangles of the source mesh with textures or vertex colours.
    pub textured: Vec<TexturedTriangle>,
    /// Element size from the file (`extras.element_size`), metres.
    pub element_size: Option<f64>,
    /// Local solver from the file (`extras.local_solver`).
    pub local_solver: Option<LocalSolver>,
}

/// A triangle or flat convex quad of the source mesh.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Surface {
    /// Corners, counter-clockwise seen from the front.
    pub corners: Corners,
    /// Its material.
    pub material: MaterialId,
    /// Lightmap coordinates of its corners (TEXCOORD_1), if there are any; (0, 0) is the upper left corner. A
    /// triangle's last is repeated. They are an affine function of the corners.
    pub lightmap: Option<[DVec2; 4]>,
    /// Whether its back faces into a closed shell without light inside: it is dark, and has no elements even if the
    /// material is double-sided.
    pub back_hidden: bool,
}

impl Part {
    /// Whether light may fall on both sides of a surface of this part.
    pub fn is_two_sided(&self, surface: &Surface) -> bool {
        self.materials[surface.material.index()].double_sided && !surface.back_hidden
    }
}

impl Surface {
    /// A surface without lightmap coordinates.
    pub fn new(corners: Corners, material: MaterialId) -> Self {
        Self { corners, material, lightmap: None, back_hidden: false }
    }

    /// The same surface seen from behind.
    pub fn flipped(&self) -> Self {
        let count = self.corners.as_slice().len();
        let lightmap = self.lightmap.map(|mut places| {
            places[..count].reverse();
            if count == 3 {
                places[3] = places[2];
            }
            places
        });
        Self { corners: self.corners.flipped(), lightmap, ..*self }
    }

    /// The surface after `placement`. A mirrored placement reverses the order of the corners, so that they stay
    /// counter-clockwise from the front.
    pub fn placed(&self, placement: DAffine3) -> Self {
        let placed = Self { corners: self.corners.map(|corner| placement.transform_point3(corner)), ..*self };
        if placement.matrix3.determinant() < 0.0 { placed.flipped() } else { placed }
    }
}

/// A material. Linear RGB, BT.709 primaries.
#[derive(Debug, Clone, PartialEq)]
pub struct Material {
    /// The material's name in the file, or empty.
    pub name: String,
    /// Diffuse reflectance ρ, 0..1, from glTF's base colour factor.
    pub reflectance: Rgb,
    /// Emission E = πL, W/m², where the radiance L is emissiveFactor × emissive strength.
    pub emission: Rgb,
    /// Whether the back reflects and emits as the front does; a one-sided surface is black on its back.
    pub double_sided: bool,
    /// The textures on both.
    pub textures: Textures,
}

/// The solver of a part's local equilibrium. The result does not depend on it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[cfg_attr(feature = "cli", derive(clap::ValueEnum))]
#[serde(rename_all = "kebab-case")]
pub enum LocalSolver {
    /// LU factors of I − ρF, kept with the part
    Direct,
    /// Gauss-Seidel iteration over the stored rows
    GaussSeidel,
    /// Progressive refinement: the brightest unshot element first (Southwell)
    Progressive,
    /// GMRES on the stored rows
    Iterative,
}
