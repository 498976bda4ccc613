//! The power balance after a round: emitted = absorbed + escaped + travelling.
//!
//! Collocation is exact by rows, not in energy: of the power that element j sends, Σ_i A_i F_ij / A_j arrives. In a
//! closed scene this should be 1, but it is so only on average. Power that does not arrive counts as escaped.

use crate::exchange::groups::Group;
use equilux_formats::Rgb;
use rayon::prelude::*;
use serde::Serialize;

/// Power, W, channel by channel.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize)]
pub struct Energy {
    /// Σ A E.
    pub emitted: Rgb,
    /// Σ A (1 − ρ) H: arriving power that is not reflected.
    pub absorbed: Rgb,
    /// Power that leaves elements and does not arrive: through openings, or in a closed scene the error of
    /// collocation.
    pub escaped: Rgb,
    /// Power that has arrived and is not reflected yet, Σ A r; negative where more was reflected than arrived.
    pub travelling: Rgb,
}

/// The share of each element's sent power that arrives in the group.
#[derive(Debug)]
pub struct ColumnSums(Vec<f64>);

impl ColumnSums {
    /// Column sums Σ_i A_i F_ij / A_j, one for each element of the group.
    pub fn of(group: &Group) -> Self {
        let mut arriving = vec![0.0; group.scene_senders()];
        for (m, system) in group.systems().enumerate() {
            for (block, first) in [(system.self_block, group.senders_of(m).start), (system.coupling, 0)] {
                let scattered = |rows: usize| {
                    let areas: Vec<[f64; 1]> = block.receivers_of(rows).map(|i| [system.areas[i]]).collect();
                    block.scatter_group(rows, &areas)
                };
                let sums: Vec<_> = (0..block.groups()).into_par_iter().map(scattered).collect();
                for (sender, [sum]) in sums.into_iter().flatten() {
                    arriving[first + sender] += sum;
                }
            }
        }
        let members = 0..group.members.len();
        Self(members.flat_map(|m| shares(group, m, &arriving[group.senders_of(m)])).collect())
    }

    /// The smallest and the largest column sum.
    pub fn range(&self) -> [f64; 2] {
        self.0.iter().fold([f64::INFINITY, 0.0], |[low, high], &sum| [low.min(sum), high.max(sum)])
    }

    /// The power balance of a group with this radiosity and residual, both W/m².
    pub fn account(&self, group: &Group, radiosity: &[Rgb], residual: &[Rgb]) -> Energy {
        let areas = group.systems().flat_map(|system| system.areas.iter().zip(&system.optics.emission));
        let mut energy = Energy::default();
        for (((&area, emission), share), (b, r)) in areas.zip(&self.0).zip(radiosity.iter().zip(residual)) {
            for c in 0..3 {
                let (sent, arriving) = (area * b[c], area * b[c] * share);
                // Reflected power is sent power minus emission, plus what the residual still adds.
                let reflected = sent - area * (emission[c] - r[c]);
                energy.emitted[c] += area * emission[c];
                energy.absorbed[c] += arriving - reflected;
                energy.escaped[c] += sent - arriving;
                energy.travelling[c] += area * r[c];
            }
        }
        energy
    }
}

/// The column sums of a member's elements from the power that arrives from each of its senders, W.
fn shares(group: &Group, member: usize, arriving: &[f64]) -> Vec<f64> {
    let system = group.system(member);
    let elements = system.areas.len();
    // A part's tree measures areas in the part's units.
    let scale = if elements == 0 { 1.0 } else { system.areas[0] / system.clusters.area_of(0) };
    let area = |sender: usize| match system.areas.get(sender) {
        Some(&area) => area,
        None => system.clusters.area_of(sender) * scale,
    };
    // Nothing is sent from where everything is covered.
    let share = |(sender, power): (usize, &f64)| if area(sender) > 0.0 { power / area(sender) } else { 0.0 };
    let mut shares: Vec<f64> = arriving.iter().enumerate().map(share).collect();
    // Each element of a cluster has the cluster's share; outer clusters come first.
    for (cluster, pair) in system.clusters.children().iter().enumerate() {
        pair.iter().for_each(|&child| shares[child as usize] += shares[elements + cluster]);
    }
    shares.truncate(elements);
    shares
}

impl std::ops::AddAssign for Energy {
    fn add_assign(&mut self, other: Self) {
        self.emitted = self.emitted + other.emitted;
        self.absorbed = self.absorbed + other.absorbed;
        self.escaped = self.escaped + other.escaped;
        self.travelling = self.travelling + other.travelling;
    }
}
