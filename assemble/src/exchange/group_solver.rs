//! The rounds of one group of parts: corrections until the required bound is proved. All methods use the same block
//! correction; they differ in the order of the turns and in how the correction is applied.

use crate::exchange::block_correction::BlockCorrection;
use crate::exchange::bound::Margin;
use crate::exchange::coarse::{Coarse, pays};
use crate::exchange::energy::ColumnSums;
use crate::exchange::error_estimate::ErrorEstimate;
use crate::exchange::groups::Group;
use crate::exchange::listener::{FinishedRound, Listener};
use crate::exchange::outcome::{Convergence, is_shown};
use crate::exchange::settings::{Goal, Method};
use crate::exchange::step_times::{Overhead, StepTimes, timed};
use equilux_bake::equilibrium::krylov::Space;
use equilux_bake::equilibrium::largest;
use equilux_bake::monitor::Monitor;
use equilux_formats::Rgb;
use std::time::{Duration, Instant};

/// Number of turns when the block correction is a preconditioner: most neighbours use each other's newest
/// corrections, and a quarter of all parts is solved in parallel.
const PRECONDITIONER_TURNS: usize = 4;

/// Share of the sources that a local solver may leave in a preconditioner.
const PRECONDITIONER_TOLERANCE: f64 = 3e-3;

/// The rounds have stalled if the proved bound did not shrink below this share of the previous one.
const MAX_STALLED_RATIO: f64 = 0.5;

/// Solves the equation of one group.
pub struct GroupSolver<'a> {
    group: &'a Group<'a>,
    coarse: Option<Coarse<'a>>,
    margin: Margin,
    columns: ColumnSums,
    correction: BlockCorrection<'a>,
    krylov: bool,
}

/// A round of one group.
pub struct GroupRound {
    /// Error and power balance after it.
    pub estimate: ErrorEstimate,
    /// Wall time.
    pub time: Duration,
    /// Radiosity after the round, W/m², if it is to be drawn or was the last.
    pub radiosity: Option<Vec<Rgb>>,
}

/// Result for a group. Vectors of the group.
pub struct GroupOutcome {
    /// W/m².
    pub radiosity: Vec<Rgb>,
    /// W/m².
    pub irradiance: Vec<Rgb>,
    /// The rounds; empty if the start was already within the bound.
    pub rounds: Vec<GroupRound>,
    /// Error and power balance of the result.
    pub estimate: ErrorEstimate,
    /// Whether the goal was met.
    pub converged: bool,
    /// Number of local solves that were skipped because the sources were zero.
    pub idle: usize,
    /// Unknowns of the coarse space; 0 if there is none.
    pub coarse: usize,
}

/// State of a group during the rounds.
struct SolverState {
    radiosity: Vec<Rgb>,
    /// F B, as of its last recomputation.
    irradiance: Vec<Rgb>,
    /// The residual E + ρF B − B, updated from round to round.
    residual: Vec<Rgb>,
    /// The radiosity at the start of the Krylov space, and the space, for Krylov methods.
    krylov: Option<(Vec<Rgb>, Space)>,
    /// The relative bound when the residual was last recomputed; infinite before.
    proved_bound: f64,
}

/// Error after a round, and whether the rounds can end.
struct Assessment {
    estimate: ErrorEstimate,
    /// Whether the goal is met.
    converged: bool,
    /// Whether no further progress is possible.
    stalled: bool,
}

impl<'a> GroupSolver<'a> {
    /// Set up the solver of a group for `method`.
    pub fn new(group: &'a Group<'a>, method: Method, goal: Goal, spent: &mut Overhead) -> Self {
        let count = group.members.len();
        let krylov = matches!(method, Method::Auto | Method::Gmres) && count > 1;
        let wanted = method == Method::Gmres
            || pays(group.systems().map(|system| system.answers.returned), goal.error);
        let coarse = timed(&mut spent.coarse, || if krylov && wanted { Coarse::of(group) } else { None });
        let turns = match method {
            Method::Jacobi => 1,
            Method::GaussSeidel => count,
            Method::Auto | Method::Gmres => PRECONDITIONER_TURNS,
        };
        let margin = timed(&mut spent.margin, || Margin::of(group, coarse.as_ref(), PRECONDITIONER_TURNS));
        let columns = timed(&mut spent.account, || ColumnSums::of(group));
        let correction = BlockCorrection::new(group, turns, krylov.then_some(PRECONDITIONER_TOLERANCE));
        Self { group, coarse, margin, columns, correction, krylov }
    }

    /// Smallest and largest column sum.
    pub fn column_sums(&self) -> [f64; 2] {
        self.columns.range()
    }

    /// Run rounds from `start`, or from zero if none, until the goal is met, no further progress is possible, or `monitor` or
    /// `listener` stops the exchange.
    pub fn run(
        mut self,
        start: Option<Vec<Rgb>>,
        goal: Goal,
        times: &mut StepTimes,
        monitor: &Monitor,
        listener: &dyn Listener,
    ) -> GroupOutcome {
        let is_warm = start.is_some();
        let mut state = self.begin(start);
        let mut estimate = self.estimate(&state, times);
        if is_warm {
            estimate.error_bound = self.sharp_bound(&state, times);
        }
        let must_end = |rounds: usize| rounds >= goal.rounds || monitor.stopped() || listener.ends_exchange();
        let mut converged = is_warm && estimate.is_within(goal.error);
        let mut rounds: Vec<GroupRound> = Vec::new();
        let mut is_last = converged || must_end(0);
        while !is_last {
            let start = Instant::now();
            self.advance(&mut state, times);
            is_last = must_end(rounds.len() + 1);
            let assessment = self.assess(&mut state, goal, is_last, times);
            is_last |= assessment.converged || assessment.stalled;
            (estimate, converged) = (assessment.estimate, assessment.converged);
            drop_hidden(&mut rounds);
            let radiosity = Some(state.radiosity.clone());
            rounds.push(GroupRound { estimate, time: start.elapsed(), radiosity });
            monitor.advance(1);
            listener.round(&FinishedRound {
                instances: &self.group.members,
                number: rounds.len(),
                convergence: Convergence::default().with(&estimate),
                times,
                is_last,
                radiosity: &state.radiosity,
            });
        }
        if !(is_warm && rounds.is_empty()) {
            estimate.error_bound = self.sharp_bound(&state, times);
        }
        improve_estimates(&mut rounds, estimate, &state.radiosity);
        self.outcome(state, rounds, estimate, converged)
    }

    fn outcome(
        &self,
        state: SolverState,
        rounds: Vec<GroupRound>,
        estimate: ErrorEstimate,
        converged: bool,
    ) -> GroupOutcome {
        let skipped = self.group.skipped_irradiance(&state.radiosity);
        GroupOutcome {
            irradiance: sum(&state.irradiance, &skipped),
            radiosity: state.radiosity,
            rounds,
            estimate,
            converged,
            idle: self.correction.idle,
            coarse: self.coarse.as_ref().map_or(0, Coarse::unknowns),
        }
    }

    /// Estimate the error after a round, and decide whether the goal is met or no further progress is possible. The residual
    /// is recomputed before anything counts as proved.
    fn assess(
        &self,
        state: &mut SolverState,
        goal: Goal,
        is_last: bool,
        times: &mut StepTimes,
    ) -> Assessment {
        let estimate = self.estimate(state, times);
        let settled = estimate.is_rounded() || state.is_full();
        if !(estimate.is_within(goal.error) || settled || is_last) {
            return Assessment { estimate, converged: false, stalled: false };
        }
        timed(&mut times.overhead.proof, || self.refresh(state));
        let estimate = self.estimate(state, times);
        let stalled = settled && estimate.relative_bound() > MAX_STALLED_RATIO * state.proved_bound;
        state.proved_bound = estimate.relative_bound();
        // With a required error of 0, the goal is met when rounding prevents further progress.
        let converged = estimate.is_within(goal.error) || (stalled && goal.error == 0.0);
        Assessment { estimate, converged, stalled }
    }

    fn begin(&self, start: Option<Vec<Rgb>>) -> SolverState {
        let dark = || vec![Rgb::BLACK; self.group.elements()];
        let irradiance = start.as_ref().map_or_else(dark, |start| self.group.irradiance(start));
        let radiosity = start.unwrap_or_else(dark);
        let residual = self.group.residual(&radiosity, &irradiance);
        let krylov = self.krylov.then(|| (radiosity.clone(), Space::new(&residual)));
        SolverState { radiosity, irradiance, residual, krylov, proved_bound: f64::INFINITY }
    }

    /// One round: apply a correction and update the residual.
    fn advance(&mut self, state: &mut SolverState, times: &mut StepTimes) {
        let Some((base, space)) = &mut state.krylov else {
            let (z, az) = self.correction.correct(&state.residual, None, times);
            state.radiosity = sum(&state.radiosity, &z);
            state.residual = state.residual.iter().zip(az).map(|(&r, az)| r - az).collect();
            return;
        };
        let coarse = || self.coarse.as_ref().and_then(|coarse| coarse.correct(space.newest()));
        let start = timed(&mut times.overhead.krylov, coarse);
        let (z, az) = self.correction.correct(space.newest(), start, times);
        timed(&mut times.overhead.krylov, || {
            space.add(z, az);
            state.radiosity = sum(base, &space.correction());
            state.residual = space.residual();
        });
    }

    /// Recompute irradiance and residual from the radiosity.
    fn refresh(&self, state: &mut SolverState) {
        state.irradiance = self.group.irradiance(&state.radiosity);
        state.residual = self.group.residual(&state.radiosity, &state.irradiance);
        state.krylov = self.krylov.then(|| (state.radiosity.clone(), Space::new(&state.residual)));
    }

    fn estimate(&self, state: &SolverState, times: &mut StepTimes) -> ErrorEstimate {
        timed(&mut times.overhead.estimates, || ErrorEstimate {
            residual: largest(&state.residual),
            error_bound: self.margin.bound(&state.residual, &state.radiosity),
            brightest: largest(&state.radiosity),
            energy: self.columns.account(self.group, &state.radiosity, &state.residual),
        })
    }

    fn sharp_bound(&self, state: &SolverState, times: &mut StepTimes) -> Rgb {
        let bound = || self.margin.sharp_bound(self.group, &state.residual, &state.radiosity);
        timed(&mut times.overhead.proof, bound)
    }
}

impl SolverState {
    fn is_full(&self) -> bool {
        self.krylov.as_ref().is_some_and(|(_, space)| space.is_full())
    }
}

/// Drop the radiosity of the last round if it is not drawn, since another round follows.
fn drop_hidden(rounds: &mut [GroupRound]) {
    let number = rounds.len();
    if let Some(last) = rounds.last_mut().filter(|_| !is_shown(number)) {
        last.radiosity = None;
    }
}

/// Improve the estimates of all rounds by the final result. The last round gets the final estimate; earlier rounds
/// are bounded by |B − B_n| ≤ |B − B_N| + |B_N − B_n|.
fn improve_estimates(rounds: &mut [GroupRound], estimate: ErrorEstimate, light: &[Rgb]) {
    let Some(last) = rounds.last_mut() else { return };
    last.estimate = estimate;
    let proved = estimate.error_bound;
    for round in rounds {
        let Some(earlier) = &round.radiosity else { continue };
        let moved = earlier
            .iter()
            .zip(light)
            .fold(Rgb::BLACK, |most: Rgb, (&a, &b)| Rgb::from_fn(|c| most[c].max((a[c] - b[c]).abs())));
        let bound = &mut round.estimate.error_bound;
        *bound = Rgb::from_fn(|c| bound[c].min(moved[c] + proved[c]));
    }
}

fn sum(a: &[Rgb], b: &[Rgb]) -> Vec<Rgb> {
    a.iter().zip(b).map(|(&a, &b)| a + b).collect()
}
