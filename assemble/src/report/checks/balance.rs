//! Power that does not balance: a closed scene absorbs what it emits, except for the error of collocation.
//!
//! Of the power that element j sends, Σ_i A_i F_ij / A_j arrives. F_ij is computed at the receivers' centroids, so
//! where a sender is closer to a receiver than the receiver is wide, the sum may be far from one: for instance, a
//! lamp under a ceiling.

use super::ray_sample::RaySample;
use crate::exchange::outcome::Outcome;
use crate::exchange::system::InstanceSystem;
use crate::placed_parts::PlacedParts;
use std::collections::BTreeMap;

/// Maximum share of the power that may be lost or gained.
const MAX_IMBALANCE_SHARE: f64 = 0.01;

/// A note, if a closed scene absorbs noticeably more or less than it emits.
pub(super) fn note(
    placed: &PlacedParts,
    systems: &[InstanceSystem],
    outcome: &Outcome,
    rays: &RaySample,
) -> Option<String> {
    let energy = &outcome.convergence.energy;
    let channel = (0..3).max_by(|&a, &b| energy.emitted[a].total_cmp(&energy.emitted[b]))?;
    let (emitted, absorbed) = (energy.emitted[channel], energy.absorbed[channel]);
    // Light that meets black backs is absorbed there and not counted.
    let gained = absorbed > (1.0 + MAX_IMBALANCE_SHARE) * emitted;
    let lost = absorbed < (1.0 - MAX_IMBALANCE_SHARE) * emitted && !rays.shows_backs();
    if emitted <= 0.0 || !(gained || lost) || !rays.is_closed() {
        return None;
    }
    let (sender, receiver) = culprits(placed, systems, outcome, channel, gained)?;
    let name = |k: usize| format!("`{}`", placed.instances[k].name);
    let where_ = if sender == receiver {
        format!("faces of {}", name(sender))
    } else {
        format!("{} and {}", name(sender), name(receiver))
    };
    Some(format!(
        "the scene is closed, but absorbs {:.1} % of what it emits: {where_} are nearer to each other than their elements are \
         wide; give them smaller elements (element_size in the node's extras, or --element-size)",
        100.0 * absorbed / emitted
    ))
}

/// The sender and the receiver between which the most power is gained or lost.
fn culprits(
    placed: &PlacedParts,
    systems: &[InstanceSystem],
    outcome: &Outcome,
    channel: usize,
    gained: bool,
) -> Option<(usize, usize)> {
    let radiosity = placed.split(&outcome.radiosity);
    let means: Vec<Vec<f64>> = systems
        .iter()
        .zip(&radiosity)
        .map(|(system, b)| system.clusters.means(b).into_iter().map(|b| b[channel]).collect())
        .collect();
    // Power that each instance receives from each other, and power that each sends.
    let mut arriving: BTreeMap<(usize, usize), f64> = BTreeMap::new();
    for (k, system) in systems.iter().enumerate() {
        for (block, first) in [(system.self_block, placed.columns_of(k).start), (system.coupling, 0)] {
            for group in 0..block.groups() {
                let areas: Vec<[f64; 1]> = block.receivers_of(group).map(|i| [system.areas[i]]).collect();
                for (column, [area]) in block.scatter_group(group, &areas) {
                    let sender = placed.instance_of_column(first + column);
                    let place = first + column - placed.columns_of(sender).start;
                    *arriving.entry((sender, k)).or_default() += area * means[sender][place];
                }
            }
        }
    }
    let sent =
        |k: usize| systems[k].areas.iter().zip(&radiosity[k]).map(|(a, b)| a * b[channel]).sum::<f64>();
    let received = |k: usize| arriving.range((k, 0)..(k + 1, 0)).map(|(_, power)| power).sum::<f64>();
    let off = |&k: &usize| (received(k) - sent(k)) * if gained { 1.0 } else { -1.0 };
    let sender = (0..systems.len()).max_by(|a, b| off(a).total_cmp(&off(b)))?;
    let nearest = arriving.range((sender, 0)..(sender + 1, 0)).max_by(|a, b| a.1.total_cmp(b.1))?;
    Some((sender, nearest.0.1))
}
