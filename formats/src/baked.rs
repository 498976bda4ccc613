//! A baked part: its geometry, its self block of form factors, and its local equilibrium.

use crate::geometry::{Geometry, Optics, Tints};
use crate::part::{LocalSolver, Material};
use crate::rgb::Rgb;
use crate::rows::Rows;
use serde::{Deserialize, Serialize};

/// A part with all results that do not depend on the scene.
#[derive(Debug, Clone, PartialEq)]
pub struct BakedPart {
    /// The part's name.
    pub name: String,
    /// Elements and faces, in the part's own coordinates.
    pub geometry: Geometry,
    /// Reflectance and emission, one row an element.
    pub optics: Optics,
    /// The factors that textures multiply these by, one row an element.
    pub tints: Tints,
    /// The materials, for rendering and export.
    pub materials: Vec<Material>,
    /// F_kk with nothing but the part itself in the way, `unknowns × senders of the part`.
    pub self_block: Rows,
    /// What the rays of counted rows may still meet in a scene; empty if rows are exact.
    pub escapes: Escapes,
    /// Its local equilibrium, one row an unknown.
    pub local: LocalEquilibrium,
}

/// The part's own solution with nothing arriving from outside: (I − ρF_kk) B = E.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct LocalEquilibrium {
    /// The solver that computed it, which the exchange also uses.
    pub solver: LocalSolver,
    /// Radiosity B, W/m², linear RGB, one row an unknown.
    pub radiosity: Vec<Rgb>,
    /// The factors of I − ρF_kk; only the direct solver keeps them.
    pub factors: Option<Factors>,
    /// The part's responses to light from outside.
    pub answers: BoundaryResponses,
}

/// A part's responses to light from outside. The exchange uses them as a coarse space, to accelerate its convergence.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct BoundaryResponses {
    /// The part's radiosity under some simple lights from outside, one vector a light, one row an unknown; orthonormal
    /// by area in each channel: Σ_i A_i a_i b_i is 1 for a = b, else 0. Vectors that a channel lacks are zero there.
    pub radiosity: Vec<Vec<Rgb>>,
    /// Σ_i A_i a_i ((I − ρF_kk) b)_i for each pair of them, row-major.
    pub matrix: Vec<Rgb>,
    /// The share of uniform light from outside that leaves the part again.
    pub returned: Rgb,
}

/// I − ρF_kk factored. Colour channels with the same reflectance everywhere share their factors.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Factors {
    /// One LU a distinct channel, at most three.
    pub channels: Vec<Lu>,
    /// Which of `channels` red, green and blue use.
    pub of_channel: [u32; 3],
}

/// P A = L U of a square matrix A, dense, with row pivoting.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Lu {
    /// Number of rows and of columns.
    pub size: u32,
    /// L below the diagonal (its own diagonal is 1), U on and above it; `size × size`, column-major.
    pub packed: Vec<f64>,
    /// The permutation: row i of L U is row `rows[i]` of A.
    pub rows: Vec<u32>,
}

/// The contents of a part file: results that depend on geometry and settings only, so that repainting keeps them.
#[derive(Debug, Clone, PartialEq)]
pub struct BakedGeometry {
    /// Elements and faces, in the part's own coordinates.
    pub geometry: Geometry,
    /// F_kk with nothing but the part itself in the way, `unknowns × senders of the part`.
    pub self_block: Rows,
    /// What the rays of counted rows may still meet in a scene; empty if rows are exact.
    pub escapes: Escapes,
}

/// What the rays of a part's counted rows may still meet in a scene.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Escapes {
    /// The rays that leave the part: a bit a ray, in as many words a row as its rays need.
    pub escaped: Vec<u64>,
    /// Rays a row that start inside a solid of the part.
    pub covered: Vec<u16>,
    /// For each row a box around its rays up to what they meet in the part, or as far as something may cover their start if they
    /// leave it: lowest and highest corner, rounded outwards.
    pub reach: Vec<[f32; 6]>,
}

impl Escapes {
    /// The escaped rays of a row, of `rays`, as bits.
    pub fn of_row(&self, row: usize, rays: u32) -> &[u64] {
        let words = rays.div_ceil(64) as usize;
        &self.escaped[row * words..(row + 1) * words]
    }
}

/// The contents of a light file: results that also depend on reflectance and emission.
#[derive(Debug, Clone, PartialEq)]
pub struct BakedLight {
    /// Reflectance and emission, one row an element.
    pub optics: Optics,
    /// The part's local equilibrium.
    pub local: LocalEquilibrium,
}
