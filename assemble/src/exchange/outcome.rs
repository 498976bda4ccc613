//! The result of an exchange: the light, the rounds that led to it and the proved error.

use crate::exchange::energy::Energy;
use crate::exchange::error_estimate::ErrorEstimate;
use crate::exchange::step_times::StepTimes;
use equilux_formats::Rgb;
use std::time::Duration;

/// The light in the end.
#[derive(Debug)]
pub struct Outcome {
    /// Radiosity of all elements.
    pub radiosity: Vec<Rgb>,
    /// Irradiance of all elements.
    pub irradiance: Vec<Rgb>,
    /// The rounds; none if the light to start from already was within the bound.
    pub rounds: Vec<Round>,
    /// What is known of the light in the end.
    pub convergence: Convergence,
    /// Where time went.
    pub times: StepTimes,
    /// Whether the goal was met.
    pub converged: bool,
    /// What the rounds did not have to do.
    pub spared: Spared,
    /// Unknowns of the coarse space, all groups together.
    pub coarse_unknowns: usize,
    /// Number of groups of parts that exchange no light with each other.
    pub groups: usize,
    /// Least and largest share of what an element sends that arrives somewhere.
    pub column_sums: [f64; 2],
}

/// What changes no radiosity and was left out of the rounds.
#[derive(Debug, Clone, Copy, Default)]
pub struct Spared {
    /// Rows of black receivers, gathered once in the end.
    pub black_rows: usize,
    /// Local equilibria of instances in which nothing shone, all rounds together.
    pub dark_solves: usize,
    /// Coarse spaces of groups of parts that return so little light that few rounds do without.
    pub coarse_spaces: usize,
}

/// What a round left behind. Parts that exchange no light with each other have rounds of their own, which are counted
/// together.
#[derive(Debug, Clone)]
pub struct Round {
    /// 1 for the first.
    pub number: usize,
    /// What is known of the light after it.
    pub convergence: Convergence,
    /// Wall time of the round.
    pub time: Duration,
    /// Radiosity of all elements after the round, if there is to be a picture of it.
    pub radiosity: Option<Vec<Rgb>>,
}

/// What is known of light on its way to equilibrium.
#[derive(Debug, Clone, Copy, Default)]
pub struct Convergence {
    /// Largest residual, W/m².
    pub residual: f64,
    /// No radiosity is further than this from the solution with the form factors as they are kept, W/m².
    pub error_bound: f64,
    /// The bound over the brightest radiosity of the same group of parts and the same channel, the worst of all.
    pub relative_bound: f64,
    /// Where the power is.
    pub energy: Energy,
}

impl Convergence {
    /// The same with another group of parts.
    pub fn with(mut self, estimate: &ErrorEstimate) -> Self {
        self.residual = estimate.residual.into_iter().fold(self.residual, f64::max);
        self.error_bound = estimate.error_bound.into_iter().fold(self.error_bound, f64::max);
        self.relative_bound = self.relative_bound.max(estimate.relative_bound());
        self.energy += estimate.energy;
        self
    }
}

/// Whether there is to be a picture of this round even if it is not the last: of the first eight, then of powers of two.
pub fn is_shown(round: usize) -> bool {
    round <= 8 || round.is_power_of_two()
}
