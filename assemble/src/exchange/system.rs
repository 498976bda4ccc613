//! One instance's block row of the radiosity equation B = E + ρFB, and its residual.

use equilux_bake::equilibrium::LocalSystem;
use equilux_formats::{BoundaryResponses, ClusterTree, Optics, Rgb, Rows};

/// One instance's share of the equation.
#[derive(Debug)]
pub struct InstanceSystem<'a> {
    /// Reflectance and emission in this place.
    pub optics: Optics,
    /// F_kk in the scene.
    pub self_block: &'a Rows,
    /// The hierarchy of the part's elements.
    pub clusters: &'a ClusterTree,
    /// F_kl for l ≠ k; columns count through all nodes of the scene.
    pub coupling: &'a Rows,
    /// Solves the instance on its own.
    pub local: LocalSystem<'a>,
    /// How it answers light from outside.
    pub answers: &'a BoundaryResponses,
    /// Area of its elements in the scene, m².
    pub areas: Vec<f64>,
}

/// r = E + ρH − B with the irradiance H of that B, W/m², one vector an instance.
pub fn residual(
    systems: &[InstanceSystem],
    radiosity: &[Vec<Rgb>],
    irradiance: &[Vec<Rgb>],
) -> Vec<Vec<Rgb>> {
    let of = |system: &InstanceSystem, b: &[Rgb], h: &[Rgb]| -> Vec<Rgb> {
        (0..b.len())
            .map(|i| {
                let right = system.optics.emission[i] + system.optics.reflectance[i] * h[i];
                right - b[i]
            })
            .collect()
    };
    systems.iter().zip(radiosity).zip(irradiance).map(|((system, b), h)| of(system, b, h)).collect()
}
