//! Parts before baking: flat convex surfaces with materials, in the part's own coordinates.

use crate::geometry::Corners;
use crate::ids::MaterialId;
use crate::rgb::Rgb;
use crate::texture::{TexturedTriangle, Textures};
use glam::{DAffine3, DVec2, DVec3};
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
    /// Normals of its corners towards its front, of any length, where the mesh stands for a smooth surface (NORMAL): they
    /// differ from that of the face. A triangle's last is repeated.
    pub normals: Option<[DVec3; 4]>,
    /// Whether its back faces into a closed shell without light inside: it is dark, and has no elements even if the
    /// material is double-sided.
    pub back_hidden: bool,
    /// What the nodes below the part's root choose for its texels.
    pub texels: TexelChoice,
}

/// An author's choice about the texels of a lightmap. What a surface leaves open, its instance decides.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct TexelChoice {
    /// Maximum size of a texel, metres of the scene (`extras.texel_size`).
    pub size: Option<f64>,
    /// Whether there are any (`extras.lightmap`).
    pub any: Option<bool>,
}

impl TexelChoice {
    /// This choice, completed by `other`.
    pub fn or(self, other: Self) -> Self {
        Self { size: self.size.or(other.size), any: self.any.or(other.any) }
    }
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
        Self {
            corners,
            material,
            lightmap: None,
            normals: None,
            back_hidden: false,
            texels: TexelChoice::default(),
        }
    }

    /// The same surface seen from behind.
    pub fn flipped(&self) -> Self {
        let normals = self.normals.map(|normals| normals.map(|normal| -normal));
        Self { normals, ..*self }.reversed()
    }

    /// The same surface with its corners in reverse order.
    fn reversed(&self) -> Self {
        let count = self.corners.as_slice().len();
        Self {
            corners: self.corners.flipped(),
            lightmap: self.lightmap.map(|places| reversed(places, count)),
            normals: self.normals.map(|normals| reversed(normals, count)),
            ..*self
        }
    }

    /// The surface after `placement`. A mirrored placement reverses the order of the corners, so that they stay
    /// counter-clockwise from the front.
    pub fn placed(&self, placement: DAffine3) -> Self {
        let across = placement.matrix3.inverse().transpose();
        let normals = self.normals.map(|normals| normals.map(|normal| (across * normal).normalize_or_zero()));
        let normals = normals.filter(|normals| normals.iter().all(|&normal| normal != DVec3::ZERO));
        let corners = self.corners.map(|corner| placement.transform_point3(corner));
        let placed = Self { corners, normals, ..*self };
        if placement.matrix3.determinant() < 0.0 { placed.reversed() } else { placed }
    }
}

/// The values of `count` corners in reverse order; a triangle's last is repeated.
fn reversed<T: Copy>(mut values: [T; 4], count: usize) -> [T; 4] {
    values[..count].reverse();
    if count == 3 {
        values[3] = values[2];
    }
    values
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
