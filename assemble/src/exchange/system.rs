//! One instance's block row of the radiosity equation B = E + ρFB, and its residual.

use equilux_bake::equilibrium::LocalSystem;
use equilux_formats::baked::BoundaryResponses;
use equilux_formats::{ClusterTree, Optics, Rgb, Rows};

/// One instance's block row of the equation.
#[derive(Debug)]
pub struct InstanceSystem<'a> {
    /// Reflectance and emission of the instance.
    pub optics: Optics,
    /// F_kk in the scene.
    pub self_block: &'a Rows,
    /// The hierarchy of the part's elements.
    pub clusters: &'a ClusterTree,
    /// F_kl for l ≠ k; columns count all nodes of the scene.
    pub coupling: &'a Rows,
    /// The local solver of the instance.
    pub local: LocalSystem<'a>,
    /// Boundary responses: radiosities caused by light from outside.
    pub answers: &'a BoundaryResponses,
    /// Area of its unknowns in the scene that is not covered, m².
    pub areas: Vec<f64>,
}

/// Residual E + ρH − B, W/m², one vector for each instance, with the irradiance H that belongs to the radiosity B.
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
