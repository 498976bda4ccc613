//! The equation (I − ρF) B = q of one part: its self block F and reflectance ρ.

use super::columns::Columns;
use equilux_formats::baked::Factors;
use equilux_formats::{ClusterTree, LocalSolver, Rgb, Rows};
use rayon::prelude::*;
use std::sync::OnceLock;

/// A residual this small, relative to the largest radiosity, is rounding: a sum of a few thousand terms in f64.
pub(super) const ROUNDING: f64 = 1e-14;

/// The equation of one part, for many right-hand sides.
#[derive(Debug)]
pub struct LocalSystem<'a> {
    pub(super) block: &'a Rows,
    pub(super) clusters: &'a ClusterTree,
    pub(super) reflectance: &'a [Rgb],
    pub(super) solver: LocalSolver,
    pub(super) factors: Option<&'a Factors>,
    pub(super) columns: OnceLock<Columns>,
}

impl<'a> LocalSystem<'a> {
    /// The system of a square block. The direct solver needs `factors`, as [`super::factorise`] makes them.
    pub fn new(
        block: &'a Rows,
        clusters: &'a ClusterTree,
        reflectance: &'a [Rgb],
        solver: LocalSolver,
        factors: Option<&'a Factors>,
    ) -> Self {
        assert_eq!(block.receivers(), clusters.elements(), "a row an element");
        assert_eq!(block.senders(), clusters.nodes(), "a column a node");
        assert_eq!(block.receivers(), reflectance.len(), "one reflectance an element");
        Self { block, clusters, reflectance, solver, factors, columns: OnceLock::new() }
    }

    /// Irradiance F B from the part itself, W/m², one row an element.
    pub fn irradiance(&self, radiosity: &[Rgb]) -> Vec<Rgb> {
        apply(self.block, &self.clusters.means(radiosity))
    }

    /// (I − ρF) B.
    pub(super) fn without_reflection(&self, b: &[Rgb]) -> Vec<Rgb> {
        let irradiance = self.irradiance(b);
        (0..b.len()).map(|i| b[i] - self.reflectance[i] * irradiance[i]).collect()
    }
}

/// The irradiance of all receivers of a block, W/m², from the radiosity of all its senders, W/m².
pub fn apply(block: &Rows, nodes: &[Rgb]) -> Vec<Rgb> {
    (0..block.groups()).into_par_iter().flat_map_iter(|group| block.gather_group(group, nodes)).collect()
}
