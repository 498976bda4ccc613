//! Lights that are no elements of the scene: lamps, suns and the sky.

use crate::gather::lamps::Lamp;
use equilux_formats::{Geometry, Rgb};

/// What shines into a scene from outside its surfaces.
#[derive(Debug, Clone, Default)]
pub struct Lights {
    /// Points, spots and parallel light.
    pub lamps: Vec<Lamp>,
    /// Parallel light with a width.
    pub suns: Vec<Sun>,
    /// The sky's polygons, and what each sends, W/m².
    pub sky: Option<(Geometry, Vec<Rgb>)>,
}

/// A directional light that has a width: polygons far away.
#[derive(Debug, Clone)]
pub struct Sun {
    /// The light's name.
    pub name: String,
    /// What looks as wide as the sun from anywhere in the scene.
    pub polygons: Geometry,
    /// What they send, W/m².
    pub radiosity: Rgb,
    /// At most this arrives at the scene, W.
    pub power: Rgb,
}

impl Lights {
    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.lamps.is_empty() && self.suns.is_empty() && self.sky.is_none()
    }
}
