//! Which receivers get exact rows. In go the clusters that receive together, part by part; out comes a choice of them,
//! the same every time, and for how much area each speaks.
//!
//! Every part has a share of the draws by its area, at least one, at even distances along the area of its clusters in
//! order (systematic sampling, size-proportional: Cochran 1977, §11.9): large faces are drawn more often than small ones.

use crate::exchange::system::InstanceSystem;
use crate::placed_parts::PlacedParts;
use std::ops::Range;

/// How many receivers get exact rows.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ExactRows {
    /// About so many, in whole clusters of receivers; all if there are no more.
    About(usize),
    /// All.
    All,
}

impl Default for ExactRows {
    /// Enough to estimate the error of clusters to a few percent of itself.
    fn default() -> Self {
        Self::About(256)
    }
}

/// A cluster of receivers.
#[derive(Debug, Clone, PartialEq)]
pub struct ReceiverCluster {
    /// The instance.
    pub instance: usize,
    /// Its elements in the cluster, numbered within the instance.
    pub receivers: Range<usize>,
    /// For how much area it speaks, m².
    pub area: f64,
}

/// The clusters whose rows are to be exact, in order.
pub fn choose(placed: &PlacedParts, systems: &[InstanceSystem], wanted: ExactRows) -> Vec<ReceiverCluster> {
    let all: Vec<ReceiverCluster> = (0..systems.len()).flat_map(|k| clusters(placed, systems, k)).collect();
    let elements = placed.world.elements.len();
    let rows = match wanted {
        ExactRows::About(0) => return vec![],
        ExactRows::About(rows) if rows < elements => rows,
        _ => return all,
    };
    let total: f64 = all.iter().map(|cluster| cluster.area).sum();
    // Large clusters are drawn more often, so a draw brings more rows than the average cluster has.
    let rows_a_draw: f64 = all.iter().map(|c| c.receivers.len() as f64 * c.area / total).sum();
    let draws = rows as f64 / rows_a_draw;
    let mut speaks_for = vec![0.0; all.len()];
    for part in 0..placed.parts.len() {
        let own: Vec<usize> =
            (0..all.len()).filter(|&c| placed.instances[all[c].instance].part.index() == part).collect();
        let area: f64 = own.iter().map(|&c| all[c].area).sum();
        let share = (draws * area / total).round().max(1.0);
        draw(&own, &all, area / share).for_each(|cluster| speaks_for[cluster] += area / share);
    }
    let spoken = all.into_iter().zip(speaks_for).filter(|&(_, area)| area > 0.0);
    spoken.map(|(cluster, area)| ReceiverCluster { area, ..cluster }).collect()
}

/// The clusters of an instance's receivers, each with its own area.
fn clusters(placed: &PlacedParts, systems: &[InstanceSystem], instance: usize) -> Vec<ReceiverCluster> {
    let elements = &placed.world.elements[placed.world.elements_of(instance)];
    let coupling = systems[instance].coupling;
    let cluster = |group: usize| {
        let receivers = coupling.receivers_of(group);
        let area = elements[receivers.clone()].iter().map(|e| e.area).sum();
        ReceiverCluster { instance, receivers, area }
    };
    (0..coupling.groups()).map(cluster).collect()
}

/// The clusters of `own` that lie half a `step` of area from the beginning, one and a half, and so on.
fn draw<'a>(own: &'a [usize], all: &'a [ReceiverCluster], step: f64) -> impl Iterator<Item = usize> + 'a {
    let (mut passed, mut next) = (0.0, step / 2.0);
    own.iter().flat_map(move |&cluster| {
        passed += all[cluster].area;
        let first = next;
        while next < passed {
            next += step;
        }
        std::iter::repeat_n(cluster, ((next - first) / step).round() as usize)
    })
}
