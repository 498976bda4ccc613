//! Which sources face which unknowns, as the rays of the sources tell.

use crate::equation::coupling::Coupled;
use crate::equation::sources::Sources;
use crate::placed_parts::PlacedParts;
use equilux_formats::Rows;
use std::collections::BTreeSet;

/// Unknowns that share a list of the sources whose light they get by form factors: those that have a ray that ends on one of
/// them, with all of their body, since the narrow sides of a lamp have few. The rays of a source say nothing about those of a receiver, so light of all others, which receivers get along their
/// rows, is neither lost nor counted twice.
pub const NEIGHBOURS: usize = 512;

/// For each instance, for each of its runs of [`NEIGHBOURS`] unknowns, the numbers of the sources that have a ray that ends on one
/// of them, and of those of their bodies, rising.
pub fn facing(placed: &PlacedParts, coupled: &[Coupled], sources: &Sources) -> Vec<Vec<Vec<u32>>> {
    let blocks = Blocks { placed, coupled };
    let runs = |k: usize| vec![vec![]; placed.unknowns_of(k).div_ceil(NEIGHBOURS)];
    let mut met: Vec<Vec<Vec<u32>>> = (0..placed.instances.len()).map(runs).collect();
    for instance in 0..placed.instances.len() {
        let first = placed.columns_of(instance).start;
        for unknown in 0..placed.unknowns_of(instance) {
            for &source in &sources.on_column[first + unknown] {
                for (column, _) in blocks.row(instance, unknown) {
                    let other = placed.instance_of_column(column);
                    let run = (column - placed.columns_of(other).start) / NEIGHBOURS;
                    let met: &mut Vec<u32> = &mut met[other][run];
                    if met.last() != Some(&source) {
                        met.push(source);
                    }
                }
            }
        }
    }
    for met in met.iter_mut().flatten() {
        let once: BTreeSet<u32> = met.drain(..).collect();
        let bodies = once.iter().flat_map(|&source| &sources.body_of[source as usize]);
        *met = bodies.copied().collect::<BTreeSet<u32>>().into_iter().collect();
    }
    met
}

/// For each instance the numbers of the sources that face any of it, rising.
pub fn facing_instances(placed: &PlacedParts, coupled: &[Coupled], sources: &Sources) -> Vec<Vec<u32>> {
    let all = |runs: Vec<Vec<u32>>| runs.into_iter().flatten().collect::<BTreeSet<u32>>();
    let runs = facing(placed, coupled, sources).into_iter();
    runs.map(|runs| all(runs).into_iter().collect()).collect()
}

/// The blocks of a scene.
#[derive(Debug)]
pub struct Blocks<'a> {
    /// The scene.
    pub placed: &'a PlacedParts,
    /// The blocks of its instances.
    pub coupled: &'a [Coupled],
}

impl Blocks<'_> {
    /// F_kk of an instance.
    pub fn own(&self, instance: usize) -> &Rows {
        self.coupled[instance].self_block(&self.placed.part_of(instance).part.self_block)
    }

    /// The whole row of an unknown of an instance: columns of the scene and form factors.
    pub fn row(&self, instance: usize, unknown: usize) -> impl Iterator<Item = (usize, f64)> {
        let first = self.placed.columns_of(instance).start;
        let own = self.own(instance).row(unknown).map(move |(column, value)| (first + column, value));
        own.chain(self.coupled[instance].coupling.row(unknown))
    }
}
