//! The data that every output uses: the placed elements with the light on them. It borrows everything and computes
//! nothing.

use equilux_bake::world::World;
use equilux_formats::Rgb;
use glam::DVec3;

/// Placed elements, the light on them, and their names. Per-element slices follow `world.elements`.
#[derive(Debug, Clone, Copy)]
pub struct SceneLight<'a> {
    /// The placed elements, in scene coordinates, metres.
    pub world: &'a World,
    /// The origin of scene coordinates in those of the scene's file, metres.
    pub origin: DVec3,
    /// Diffuse reflectance ρ, 0..1, one row an element.
    pub reflectance: &'a [Rgb],
    /// Emission E, W/m², with each instance's scale, one row an element.
    pub emission: &'a [Rgb],
    /// Irradiance H, W/m², one row an element.
    pub irradiance: &'a [Rgb],
    /// Radiosity B, W/m², one row an element.
    pub radiosity: &'a [Rgb],
    /// The name of each instance's part.
    pub part_names: &'a [String],
    /// The name of each instance.
    pub instance_names: &'a [String],
}
