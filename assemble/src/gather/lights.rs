//! Lights that are not elements of the scene: lamps, suns and the sky.

use crate::gather::lamps::Lamp;
use equilux_formats::{Geometry, Rgb};

/// Lights outside the scene's surfaces.
#[derive(Debug, Clone, Default)]
pub struct Lights {
    /// Points, spots and parallel light.
    pub lamps: Vec<Lamp>,
    /// Directional lights with an angular diameter.
    pub suns: Vec<Sun>,
    /// The sky's polygons, and the radiosity of each, W/m².
    pub sky: Option<(Geometry, Vec<Rgb>)>,
}

/// A directional light with an angular diameter: polygons far away.
#[derive(Debug, Clone)]
pub struct Sun {
    /// The light's name.
    pub name: String,
    /// Polygons that have the sun's angular diameter from anywhere in the scene.
    pub polygons: Geometry,
    /// Their radiosity, W/m².
    pub radiosity: Rgb,
    /// Maximum power that can arrive at the scene, W.
    pub power: Rgb,
}

impl Lights {
    /// Whether there are no lights.
    pub fn is_empty(&self) -> bool {
        self.lamps.is_empty() && self.suns.is_empty() && self.sky.is_none()
    }
}
