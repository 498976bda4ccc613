//! What is proved about a round: |B − B̃| ≤ max_i |r_i| / (1 − ρ_i Σ_j F_ij), with the residual r = E + ρF B̃ − B̃.
//!
//! A = I − ρF has non-positive off-diagonals, so A w > 0 with w = 1 makes A⁻¹ ≥ 0 and |e| ≤ max_i(|r_i|/(A1)_i) · 1
//! (Berman & Plemmons 1994, ch. 6, on M-matrices).

use super::Node;
use equilux_bake::equilibrium::{added, scaled, subtract};
use equilux_formats::Rgb;

/// r = E + ρH − B with the irradiance H of that B, W/m², one vector an instance.
pub fn residual(nodes: &[Node], radiosity: &[Vec<Rgb>], irradiance: &[Vec<Rgb>]) -> Vec<Vec<Rgb>> {
    let of = |node: &Node, b: &[Rgb], h: &[Rgb]| -> Vec<Rgb> {
        (0..b.len())
            .map(|i| {
                let right = added(node.optics.emission[i], scaled(node.optics.reflectance[i], h[i]));
                subtract(right, b[i])
            })
            .collect()
    };
    nodes.iter().zip(radiosity).zip(irradiance).map(|((node, b), h)| of(node, b, h)).collect()
}

/// (A1)_i = 1 − ρ_i Σ_j F_ij: the share of light that each element takes out of the scene.
pub struct Margin(Vec<Vec<Rgb>>);

impl Margin {
    /// The margin of every element.
    pub fn of(nodes: &[Node]) -> Self {
        let margin = |node: &Node| {
            let rows = node.optics.reflectance.iter().enumerate();
            rows.map(|(i, rho)| {
                let seen = node.self_block.row_sum(i) + node.coupling.row_sum(i);
                rho.map(|rho| 1.0 - rho * seen)
            })
            .collect()
        };
        Self(nodes.iter().map(margin).collect())
    }

    /// No radiosity is further than this from the solution, W/m²; infinite where nothing can be proved.
    pub fn bound(&self, residual: &[Vec<Rgb>]) -> f64 {
        let pairs = self.0.iter().flatten().flatten().zip(residual.iter().flatten().flatten());
        pairs
            .map(|(&margin, &r)| {
                if r == 0.0 {
                    0.0
                } else if margin > 0.0 {
                    r.abs() / margin
                } else {
                    f64::INFINITY
                }
            })
            .fold(0.0, f64::max)
    }
}
