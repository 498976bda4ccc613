//! The result of an exchange: the radiosity, the rounds and the proved error.

use crate::exchange::energy::Energy;
use crate::exchange::error_estimate::ErrorEstimate;
use crate::exchange::step_times::StepTimes;
use equilux_formats::Rgb;
use std::time::Duration;

/// Result of an exchange.
#[derive(Debug)]
pub struct Outcome {
    /// Radiosity of all elements, W/m².
    pub radiosity: Vec<Rgb>,
    /// Irradiance of all elements, W/m².
    pub irradiance: Vec<Rgb>,
    /// The rounds; empty if the start was already within the bound.
    pub rounds: Vec<Round>,
    /// Error and power balance of the result.
    pub convergence: Convergence,
    /// Time spent.
    pub times: StepTimes,
    /// Whether the goal was met.
    pub converged: bool,
    /// Work that the rounds skipped.
    pub skipped: SkippedWork,
    /// Unknowns of the coarse space, all groups together.
    pub coarse_unknowns: usize,
    /// Number of groups of parts that exchange no light with each other.
    pub groups: usize,
    /// Smallest and largest share of an element's sent power that arrives.
    pub column_sums: [f64; 2],
}

/// Work that was skipped because it changes no radiosity.
#[derive(Debug, Clone, Copy, Default)]
pub struct SkippedWork {
    /// Rows of black receivers, gathered once at the end.
    pub black_rows: usize,
    /// Local solves that were skipped because no light arrived, in all rounds.
    pub dark_solves: usize,
    /// Groups without a coarse space because their parts return so little light that few rounds suffice.
    pub coarse_spaces: usize,
}

/// One round. Groups that exchange no light with each other have their own rounds, which are counted together.
#[derive(Debug, Clone)]
pub struct Round {
    /// 1 for the first.
    pub number: usize,
    /// Error and power balance after it.
    pub convergence: Convergence,
    /// Wall time of the round.
    pub time: Duration,
    /// Radiosity of all elements after the round, W/m², if it is to be drawn.
    pub radiosity: Option<Vec<Rgb>>,
}

/// Error and power balance during an exchange.
#[derive(Debug, Clone, Copy, Default)]
pub struct Convergence {
    /// Largest residual, W/m².
    pub residual: f64,
    /// Upper bound on the distance of any radiosity from the solution with the stored form factors, W/m².
    pub error_bound: f64,
    /// The bound relative to the brightest radiosity of the same group and channel; the worst of all.
    pub relative_bound: f64,
    /// Power balance, W.
    pub energy: Energy,
}

impl Convergence {
    /// Combined with the estimate of another group.
    pub fn with(mut self, estimate: &ErrorEstimate) -> Self {
        self.residual = estimate.residual.into_iter().fold(self.residual, f64::max);
        self.error_bound = estimate.error_bound.into_iter().fold(self.error_bound, f64::max);
        self.relative_bound = self.relative_bound.max(estimate.relative_bound());
        self.energy += estimate.energy;
        self
    }
}

/// Whether this round is drawn even if it is not the last: the first eight, then powers of two.
pub fn is_shown(round: usize) -> bool {
    round <= 8 || round.is_power_of_two()
}
