//! A part after baking: its geometry, its own block of form factors, and its light when nothing arrives from outside.

use crate::geometry::{Geometry, Optics};
use crate::part::{LocalSolver, Material};
use crate::rows::{Rgb, Rows};
use serde::{Deserialize, Serialize};

/// A part with everything that can be computed without knowing the scene.
#[derive(Debug, Clone, PartialEq)]
pub struct BakedPart {
    /// The part's name.
    pub name: String,
    /// Elements and faces, in the part's own coordinates.
    pub geometry: Geometry,
    /// Reflectance and emission, one row an element.
    pub optics: Optics,
    /// The materials, for those who draw or export the part.
    pub materials: Vec<Material>,
    /// F_kk with nothing but the part itself in the way, `elements × elements`.
    pub self_block: Rows,
    /// Its light on its own.
    pub local: LocalEquilibrium,
}

/// The part's own solution with nothing arriving from outside: (I − ρF_kk) B = E.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct LocalEquilibrium {
    /// The solver that found it and that the exchange will use again.
    pub solver: LocalSolver,
    /// Radiosity B, W/m², linear RGB, one row an element.
    pub radiosity: Vec<Rgb>,
}
