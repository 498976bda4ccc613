//! Gauss-Seidel: B_i ← q_i + ρ_i Σ_j F_ij B_j, updating elements in turn with the newest values. Cohen & Wallace 1993,
//! ch. 5.3.

use super::channels::largest;
use super::system::{LocalSystem, ROUNDING};
use equilux_formats::Rgb;

/// After this many iterations without progress, a change below 1e-12 is rounding.
const MAX_STALLED: usize = 10;

/// Iterates until the changes are rounding.
pub fn solve(system: &LocalSystem, sources: &[Rgb], guess: &[Rgb]) -> Vec<Rgb> {
    let mut nodes = system.clusters.means(guess);
    let (mut best, mut since_best) = (f64::INFINITY, 0);
    loop {
        let change = sweep(system, sources, &mut nodes);
        if change < best * 0.99 {
            (best, since_best) = (change, 0);
        } else {
            since_best += 1;
        }
        if change <= ROUNDING || (since_best >= MAX_STALLED && change <= 1e-12) {
            nodes.truncate(sources.len());
            return nodes;
        }
    }
}

/// One iteration over the elements, which also updates the clusters around each. Returns the largest change relative to
/// the channel's largest radiosity.
fn sweep(system: &LocalSystem, sources: &[Rgb], nodes: &mut [Rgb]) -> f64 {
    let mut most_change = Rgb::BLACK;
    for (i, &source) in sources.iter().enumerate() {
        let irradiance = gather(system, i, nodes);
        let new = source + system.reflectance[i] * irradiance;
        let change = new - nodes[i];
        most_change = most_change.max(change.abs());
        nodes[i] = new;
        raise_clusters(system, i, change, nodes);
    }
    let most = largest(&nodes[..sources.len()]);
    (0..3).map(|c| if most_change[c] == 0.0 { 0.0 } else { most_change[c] / most[c] }).fold(0.0, f64::max)
}

fn gather(system: &LocalSystem, receiver: usize, nodes: &[Rgb]) -> Rgb {
    let row = system.block.row(receiver);
    row.fold(Rgb::BLACK, |sum, (node, value)| sum + nodes[node] * value)
}

fn raise_clusters(system: &LocalSystem, element: usize, change: Rgb, nodes: &mut [Rgb]) {
    let area = system.clusters.area_of(element);
    let mut node = element;
    while let Some(parent) = system.clusters.parent_of(node) {
        let share = area / system.clusters.area_of(parent);
        nodes[parent] += change * share;
        node = parent;
    }
}
