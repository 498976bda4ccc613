//! The light of one part: (I − ρF) B = q, three channels, by whichever local solver the part prefers.
//!
//! In comes the part's block F, its reflectance ρ and what every element sends before its own part reflects anything:
//! q = E alone for the local equilibrium, q = E + ρ × (irradiance from other parts) during the exchange. Out comes
//! the radiosity B. All four solvers stop at rounding, so the answer does not depend on the choice.

mod direct;
pub mod endless;
mod gauss_seidel;
pub mod krylov;
mod progressive;

use equilux_formats::{Factors, LocalSolver, Rgb, Rows};
use std::sync::OnceLock;

/// Up to this many elements the direct solver is chosen when nobody chooses: its n³/3 then costs less than a second,
/// once, and every later solve n².
const DIRECT_UP_TO: usize = 2000;

/// A residual this small, relative to the largest radiosity, is rounding: a sum of a few thousand terms in f64.
const ROUNDING: f64 = 1e-14;

/// The solver for a part of `elements` elements when nobody chooses.
pub fn default_solver(elements: usize) -> LocalSolver {
    if elements <= DIRECT_UP_TO { LocalSolver::Direct } else { LocalSolver::Iterative }
}

/// One part's own equation, ready to be solved again and again.
pub struct LocalSystem<'a> {
    block: &'a Rows,
    reflectance: &'a [Rgb],
    solver: LocalSolver,
    factors: Option<&'a Factors>,
    columns: OnceLock<progressive::Columns>,
}

impl<'a> LocalSystem<'a> {
    /// The system of a square block. The direct solver needs `factors`, as [`factorise`] makes them.
    pub fn new(
        block: &'a Rows,
        reflectance: &'a [Rgb],
        solver: LocalSolver,
        factors: Option<&'a Factors>,
    ) -> Self {
        assert_eq!(block.receivers(), block.senders(), "a part's own block is square");
        assert_eq!(block.receivers(), reflectance.len(), "one reflectance an element");
        Self { block, reflectance, solver, factors, columns: OnceLock::new() }
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
            LocalSolver::GaussSeidel => gauss_seidel::solve(self.block, self.reflectance, sources, guess),
            LocalSolver::Progressive => {
                let columns = self.columns.get_or_init(|| progressive::Columns::of(self.block));
                progressive::solve(self.block, columns, self.reflectance, sources, guess)
            }
            LocalSolver::Iterative => self.iterate(sources, guess),
        }
    }

    fn iterate(&self, sources: &[Rgb], guess: &[Rgb]) -> Vec<Rgb> {
        let apply = |b: &[Rgb]| -> Vec<Rgb> {
            (0..b.len())
                .map(|i| subtract(b[i], scaled(self.reflectance[i], self.block.gather(i, b))))
                .collect()
        };
        let mut solution = guess.to_vec();
        krylov::gmres(apply, |r| r.to_vec(), sources, &mut solution, ROUNDING);
        solution
    }
}

/// The LU factors of I − ρF, if the solver wants them kept.
pub fn factorise(block: &Rows, reflectance: &[Rgb], solver: LocalSolver) -> Option<Factors> {
    (solver == LocalSolver::Direct).then(|| direct::factorise(block, reflectance))
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
