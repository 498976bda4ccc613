//! Solves the equilibrium of one part, (I − ρF) B = q, in three colour channels, with the local solver of the part.
//!
//! F is the part's self block, ρ its reflectance, and q the radiosity of every element before its own part reflects any light:
//! q = E alone for the local equilibrium, q = E + ρ × (irradiance from other parts) during the exchange. B is the
//! radiosity. All four solvers converge to rounding, so the result does not depend on the choice.

mod channels;
mod columns;
pub mod direct;
pub mod endless;
mod gauss_seidel;
pub mod krylov;
pub mod outside;
mod progressive;
mod system;

use columns::Columns;
use equilux_formats::baked::Factors;
use equilux_formats::{ClusterTree, LocalSolver, Rgb, Rows};
use system::ROUNDING;

pub use channels::largest;
pub use system::{LocalSystem, apply};

/// Up to this many elements the direct solver is the default. Its factors take n² numbers of storage and n³/3
/// operations; from a few hundred elements on, a few products with a compressed block are cheaper.
const DIRECT_UP_TO: usize = 256;

/// The default solver for a part of `elements` elements.
pub fn default_solver(elements: usize) -> LocalSolver {
    if elements <= DIRECT_UP_TO { LocalSolver::Direct } else { LocalSolver::Iterative }
}

impl LocalSystem<'_> {
    /// The radiosity B that solves (I − ρF) B = `sources`, starting from `guess`; both W/m², one row an element.
    pub fn solve(&self, sources: &[Rgb], guess: &[Rgb]) -> Vec<Rgb> {
        if sources.iter().all(|q| *q == Rgb::BLACK) {
            return vec![Rgb::BLACK; sources.len()];
        }
        match self.solver {
            LocalSolver::Direct => {
                let factors = self.factors.expect("the direct solver is given its factors");
                direct::solve(factors, sources)
            }
            LocalSolver::GaussSeidel => gauss_seidel::solve(self, sources, guess),
            LocalSolver::Progressive => {
                let columns = self.columns.get_or_init(|| Columns::of(self.block));
                progressive::solve(self, columns, sources, guess)
            }
            LocalSolver::Iterative => self.iterate(sources, guess),
        }
    }

    /// An approximate solution B and its residual, both W/m², one row an element. The norm of the residual is at most
    /// `share` of that of the sources. Solvers that cannot stop early return the solution and a residual of zero.
    pub fn solve_roughly(&self, sources: &[Rgb], share: f64) -> (Vec<Rgb>, Vec<Rgb>) {
        let nothing = vec![Rgb::BLACK; sources.len()];
        match self.solver {
            LocalSolver::Iterative => krylov::roughly(|b| self.without_reflection(b), sources, share),
            _ => (self.solve(sources, &nothing), nothing),
        }
    }

    fn iterate(&self, sources: &[Rgb], guess: &[Rgb]) -> Vec<Rgb> {
        let mut solution = guess.to_vec();
        krylov::gmres(|b| self.without_reflection(b), |r| r.to_vec(), sources, &mut solution, ROUNDING);
        solution
    }
}

/// The LU factors of I − ρF if the solver is direct.
pub fn factorise(
    block: &Rows,
    clusters: &ClusterTree,
    reflectance: &[Rgb],
    solver: LocalSolver,
) -> Option<Factors> {
    (solver == LocalSolver::Direct).then(|| direct::factorise(block, clusters, reflectance))
}
