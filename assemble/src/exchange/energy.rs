//! Where the power is after a round: emitted = absorbed + escaped + travelling.
//!
//! Collocation is exact by rows, not in energy: of what element j sends, Σ_i A_i F_ij / A_j arrives somewhere, which in a
//! closed scene should be 1 and is so only on average. Whatever does not arrive counts as escaped.

use crate::exchange::groups::Group;
use equilux_formats::Rgb;
use rayon::prelude::*;
use serde::Serialize;

/// Power, W, channel by channel.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize)]
pub struct Energy {
    /// Σ A E.
    pub emitted: Rgb,
    /// Of what arrives, what is not reflected.
    pub absorbed: Rgb,
    /// What leaves elements and arrives nowhere: through openings; where the scene is closed, what collocation costs.
    pub escaped: Rgb,
    /// What has arrived and is still to be reflected, Σ A r; negative where more was reflected than arrived.
    pub travelling: Rgb,
}

/// The share of what each element sends that arrives in the group.
pub struct Columns(Vec<f64>);

impl Columns {
    /// Column sums Σ_i A_i F_ij / A_j, one an element of the group.
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

    /// The least and the largest.
    pub fn range(&self) -> [f64; 2] {
        self.0.iter().fold([f64::INFINITY, 0.0], |[low, high], &sum| [low.min(sum), high.max(sum)])
    }

    /// The account of a state with this radiosity that misses this.
    pub fn account(&self, group: &Group, radiosity: &[Rgb], missing: &[Rgb]) -> Energy {
        let areas = group.systems().flat_map(|system| system.areas.iter().zip(&system.optics.emission));
        let mut energy = Energy::default();
        for (((&area, emission), share), (b, r)) in areas.zip(&self.0).zip(radiosity.iter().zip(missing)) {
            for c in 0..3 {
                let (sent, arriving) = (area * b[c], area * b[c] * share);
                // What an element reflects is what it sends without emitting it, and what it is still to send.
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

/// The column sums of a member's elements from the power that arrives of each of its senders.
fn shares(group: &Group, member: usize, arriving: &[f64]) -> Vec<f64> {
    let system = group.system(member);
    let elements = system.areas.len();
    // A part's own tree measures area in the part's units.
    let scale = if elements == 0 { 1.0 } else { system.areas[0] / system.clusters.area_of(0) };
    let mut shares: Vec<f64> = arriving
        .iter()
        .enumerate()
        .map(|(sender, power)| power / (system.clusters.area_of(sender) * scale))
        .collect();
    // What a cluster sends, each of its elements sends by its area; outer clusters come first.
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
