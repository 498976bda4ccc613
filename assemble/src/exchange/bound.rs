//! What is proved about an answer: |B − B̃| ≤ max_i |r_i| / (1 − ρ_i Σ_j F_ij), with the residual r = E + ρF B̃ − B̃.
//!
//! A = I − ρF has non-positive off-diagonals, so A w > 0 with w = 1 makes A⁻¹ ≥ 0 and |e| ≤ max_i(|r_i|/(A1)_i) · 1
//! (Berman & Plemmons 1994, ch. 6, on M-matrices).

use super::Node;
use equilux_bake::equilibrium::{added, apply, scaled, subtract};
use equilux_formats::{Rgb, Rows};

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

    /// No radiosity is further than this from the exact solution, W/m²; infinite where nothing can be proved.
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

/// What compressed form factors add to the residual at most, W/m², one vector an instance.
///
/// An entry for a cluster of mean radiosity B̄ stands for Σ_j F_ij B_j = F_iC B̄ + Σ_j F_ij (B_j − B̄), and the second
/// term is at most F_iC max_j |B_j − B̄|. An entry kept in steps is off by a step at most. Nothing is sampled, so the bound
/// is proved; it is coarse, because the signs in the second term mostly cancel.
pub fn compression(nodes: &[Node], radiosity: &[Vec<Rgb>]) -> Vec<Vec<Rgb>> {
    let means: Vec<Vec<Rgb>> = nodes.iter().zip(radiosity).map(|(node, b)| node.clusters.means(b)).collect();
    let (mut all_means, mut all_spreads) = (vec![], vec![]);
    let mut own_spreads = vec![];
    for (node, means) in nodes.iter().zip(&means) {
        let first = all_spreads.len();
        node.clusters.append_spreads(means, &mut all_spreads);
        own_spreads.push(all_spreads[first..].to_vec());
        all_means.extend_from_slice(means);
    }
    let of = |(k, node): (usize, &Node)| -> Vec<Rgb> {
        let own = widened(node.self_block, &own_spreads[k], &means[k]);
        let others = widened(node.coupling, &all_spreads, &all_means);
        let both = own.iter().zip(others).map(|(&a, b)| added(a, b));
        both.zip(&node.optics.reflectance).map(|(h, &rho)| scaled(rho, h)).collect()
    };
    nodes.iter().enumerate().map(of).collect()
}

/// Irradiance that may be missing: spreads through the block, and a step of every entry.
fn widened(block: &Rows, spreads: &[Rgb], means: &[Rgb]) -> Vec<Rgb> {
    let mut missing = apply(block, spreads);
    for (i, missing) in missing.iter_mut().enumerate() {
        let step = block.step_of(i);
        if step > 0.0 {
            let seen = block.row(i).fold([0.0; 3], |sum, (node, _)| added(sum, means[node].map(f64::abs)));
            *missing = added(*missing, seen.map(|b| b * step));
        }
    }
    missing
}
