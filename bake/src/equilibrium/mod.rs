//! The light of one part: (I − ρF) B = q, three channels, by whichever local solver the part prefers.
//!
//! In comes the part's block F, its reflectance ρ and what every element sends before its own part reflects anything:
//! q = E alone for the local equilibrium, q = E + ρ × (irradiance from other parts) during the exchange. Out comes
//! the radiosity B. All four solvers stop at rounding, so the answer does not depend on the choice.

pub mod direct;
pub mod endless;
mod gauss_seidel;
pub mod krylov;
pub mod outside;
mod progressive;

use equilux_formats::{ClusterTree, Factors, LocalSolver, Rgb, Rows};
use rayon::prelude::*;
use std::sync::OnceLock;

/// Up to this many elements the direct solver is chosen when nobody chooses. Its factors take n² numbers to keep and to
/// read, n³/3 to make; a handful of gathers over a compressed block is cheaper from a few hundred elements on.
const DIRECT_UP_TO: usize = 256;

/// A residual this small, relative to the largest radiosity, is rounding: a sum of a few thousand terms in f64.
const ROUNDING: f64 = 1e-14;

/// The solver for a part of `elements` elements when nobody chooses.
pub fn default_solver(elements: usize) -> LocalSolver {
    if elements <= DIRECT_UP_TO { LocalSolver::Direct } else { LocalSolver::Iterative }
}

/// One part's own equation, ready to be solved again and again.
pub struct LocalSystem<'a> {
    block: &'a Rows,
    clusters: &'a ClusterTree,
    reflectance: &'a [Rgb],
    solver: LocalSolver,
    factors: Option<&'a Factors>,
    columns: OnceLock<progressive::Columns>,
}

impl<'a> LocalSystem<'a> {
    /// The system of a square block. The direct solver needs `factors`, as [`factorise`] makes them.
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

    /// The radiosity B that solves (I − ρF) B = `sources`, starting from `guess`; both W/m², one row an element.
    pub fn solve(&self, sources: &[Rgb], guess: &[Rgb]) -> Vec<Rgb> {
        if sources.iter().all(|q| *q == [0.0; 3]) {
            return vec![[0.0; 3]; sources.len()];
        }
        match self.solver {
            LocalSolver::Direct => {
                let factors = self.factors.expect("the direct solver is given its factors");
                direct::solve(factors, sources)
            }
            LocalSolver::GaussSeidel => gauss_seidel::solve(self, sources, guess),
            LocalSolver::Progressive => {
                let columns = self.columns.get_or_init(|| progressive::Columns::of(self.block));
                progressive::solve(self, columns, sources, guess)
            }
            LocalSolver::Iterative => self.iterate(sources, guess),
        }
    }

    /// A B near that solution, and what it leaves of the sources; both W/m². Solvers that have no way to stop early leave
    /// nothing but rounding, and say so. `share` is what may be left.
    pub fn solve_roughly(&self, sources: &[Rgb], share: f64) -> (Vec<Rgb>, Vec<Rgb>) {
        let nothing = vec![[0.0; 3]; sources.len()];
        match self.solver {
            LocalSolver::Iterative => krylov::roughly(|b| self.without_reflection(b), sources, share),
            _ => (self.solve(sources, &nothing), nothing),
        }
    }

    /// F B of the part on its own, W/m².
    pub fn irradiance(&self, radiosity: &[Rgb]) -> Vec<Rgb> {
        apply(self.block, &self.clusters.means(radiosity))
    }

    fn iterate(&self, sources: &[Rgb], guess: &[Rgb]) -> Vec<Rgb> {
        let mut solution = guess.to_vec();
        krylov::gmres(|b| self.without_reflection(b), |r| r.to_vec(), sources, &mut solution, ROUNDING);
        solution
    }

    /// (I − ρF) B.
    fn without_reflection(&self, b: &[Rgb]) -> Vec<Rgb> {
        let irradiance = self.irradiance(b);
        (0..b.len()).map(|i| subtract(b[i], scaled(self.reflectance[i], irradiance[i]))).collect()
    }
}

/// The LU factors of I − ρF, if the solver wants them kept.
pub fn factorise(
    block: &Rows,
    clusters: &ClusterTree,
    reflectance: &[Rgb],
    solver: LocalSolver,
) -> Option<Factors> {
    (solver == LocalSolver::Direct).then(|| direct::factorise(block, clusters, reflectance))
}

/// The irradiance of all receivers of a block, W/m², from the radiosity of all its nodes.
pub fn apply(block: &Rows, nodes: &[Rgb]) -> Vec<Rgb> {
    (0..block.groups()).into_par_iter().flat_map_iter(|group| block.gather_group(group, nodes)).collect()
}

/// a × b, channel by channel.
pub fn scaled(a: Rgb, b: Rgb) -> Rgb {
    [a[0] * b[0], a[1] * b[1], a[2] * b[2]]
}

/// a + b, channel by channel.
pub fn added(a: Rgb, b: Rgb) -> Rgb {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

/// a − b, channel by channel.
pub fn subtract(a: Rgb, b: Rgb) -> Rgb {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

/// The largest magnitude in each channel.
pub fn largest(values: &[Rgb]) -> Rgb {
    values.iter().fold([0.0; 3], |most, v| std::array::from_fn(|c| f64::max(most[c], v[c].abs())))
}
