//! Chooses the receivers for exact rows. Input: the receiver clusters of all parts. Output: a deterministic sample of
//! them, and the area that each represents.
//!
//! Every part gets draws in proportion to its area, at least one, at equal intervals along the accumulated area of
//! its clusters (systematic sampling with probability proportional to size: Cochran 1977, §11.9), so that large faces
//! are drawn more often than small ones.

use crate::equation::Equation;
use crate::exchange::system::InstanceSystem;
use crate::placed_parts::PlacedParts;
use std::ops::Range;

/// Number of receivers whose rows are compared with exact ones.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ExactRows {
    /// About this many, in whole receiver clusters; all if there are no more.
    About(usize),
    /// All.
    All,
}

impl ExactRows {
    /// Enough to estimate an error to a few percent of itself.
    pub const ENOUGH: Self = Self::About(256);

    /// Their number, of so many.
    pub fn of(self, rows: usize) -> usize {
        match self {
            Self::About(some) => some.min(rows),
            Self::All => rows,
        }
    }
}

/// A cluster of receivers with adjacent rows.
#[derive(Debug, Clone, PartialEq)]
pub struct ReceiverCluster {
    /// The instance.
    pub instance: usize,
    /// Its elements in the cluster, numbered within the instance.
    pub receivers: Range<usize>,
    /// The area that it represents, m².
    pub area: f64,
}

/// The receiver clusters whose rows are to be exact, in order.
pub fn choose(
    placed: &PlacedParts,
    systems: &[InstanceSystem],
    requested: ExactRows,
) -> Vec<ReceiverCluster> {
    let all: Vec<ReceiverCluster> = (0..systems.len()).flat_map(|k| clusters(placed, systems, k)).collect();
    let elements = placed.world.elements.len();
    let rows = match requested.of(elements) {
        0 => return vec![],
        rows if rows < elements => rows,
        _ => return all,
    };
    let total: f64 = all.iter().map(|cluster| cluster.area).sum();
    // Large clusters are drawn more often, so a draw adds more rows than the average cluster has.
    let rows_a_draw: f64 = all.iter().map(|c| c.receivers.len() as f64 * c.area / total).sum();
    let draws = rows as f64 / rows_a_draw;
    let mut represents = vec![0.0; all.len()];
    for part in 0..placed.parts.len() {
        let own: Vec<usize> =
            (0..all.len()).filter(|&c| placed.instances[all[c].instance].part.index() == part).collect();
        let area: f64 = own.iter().map(|&c| all[c].area).sum();
        let share = (draws * area / total).round().max(1.0);
        draw(&own, &all, area / share).for_each(|cluster| represents[cluster] += area / share);
    }
    let drawn = all.into_iter().zip(represents).filter(|&(_, area)| area > 0.0);
    drawn.map(|(cluster, area)| ReceiverCluster { area, ..cluster }).collect()
}

/// The receiver clusters of an instance, each representing its own area.
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

/// The clusters of `own` at half a `step` of accumulated area from the beginning, one and a half steps, and so on.
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

/// About so many unknowns, at even steps of area.
pub fn evenly(equation: &Equation, rows: usize) -> Vec<(usize, usize)> {
    let systems = equation.systems();
    let areas = || {
        systems
            .iter()
            .enumerate()
            .flat_map(|(k, system)| system.areas.iter().enumerate().map(move |(i, &area)| ((k, i), area)))
    };
    let step = areas().map(|(_, area)| area).sum::<f64>() / rows.max(1) as f64;
    let mut passed = step / 2.0;
    let steps = areas().filter(|(_, area)| {
        passed += area;
        let is_chosen = passed >= step;
        passed %= step;
        is_chosen
    });
    steps.map(|(place, _)| place).collect()
}
