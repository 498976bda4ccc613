//! The rounds of one group of parts: corrections until the bound asked for is proved. Every method corrects by the same
//! sweep; they differ in who takes turns and in what is done with the correction.

use crate::exchange::block_correction::BlockCorrection;
use crate::exchange::bound::Margin;
use crate::exchange::coarse::{Coarse, pays};
use crate::exchange::energy::Columns;
use crate::exchange::error_estimate::ErrorEstimate;
use crate::exchange::groups::Group;
use crate::exchange::listener::{FinishedRound, Listener};
use crate::exchange::outcome::Convergence;
use crate::exchange::outcome::is_shown;
use crate::exchange::settings::Goal;
use crate::exchange::settings::Method;
use crate::exchange::step_times::Overhead;
use crate::exchange::step_times::StepTimes;
use crate::exchange::step_times::timed;
use equilux_bake::equilibrium::krylov::Space;
use equilux_bake::equilibrium::largest;
use equilux_bake::monitor::Monitor;
use equilux_formats::Rgb;
use std::time::{Duration, Instant};

/// Turns that parts take in a sweep that is to precondition: neighbours mostly hear the newest of each other, and a
/// quarter of all parts is solved side by side.
const TURNS: usize = 4;

/// What a local solver may leave when its answer is only to precondition.
const ROUGH: f64 = 3e-3;

/// How a group is solved.
pub struct GroupSolver<'a> {
    group: &'a Group<'a>,
    coarse: Option<Coarse<'a>>,
    margin: Margin,
    columns: Columns,
    sweep: BlockCorrection<'a>,
    krylov: bool,
}

/// A round of one group.
pub struct GroupRound {
    /// What is known after it.
    pub estimate: ErrorEstimate,
    /// Wall time.
    pub time: Duration,
    /// Radiosity after the round, if it is to be shown or was the last.
    pub radiosity: Option<Vec<Rgb>>,
}

/// The light of a group in the end. Vectors of the group.
pub struct GroupOutcome {
    /// W/m².
    pub radiosity: Vec<Rgb>,
    /// W/m².
    pub irradiance: Vec<Rgb>,
    /// The rounds; none if the light at the start already was within the bound.
    pub rounds: Vec<GroupRound>,
    /// What is known of the light in the end.
    pub estimate: ErrorEstimate,
    /// Whether the goal was met.
    pub converged: bool,
    /// Local equilibria that were not asked for, because nothing shone.
    pub idle: usize,
    /// Unknowns of the coarse space; none if it was left out.
    pub coarse: usize,
}

/// The light of a group on its way to equilibrium.
struct SolverState {
    radiosity: Vec<Rgb>,
    /// F B, as of when it was last computed anew.
    irradiance: Vec<Rgb>,
    /// E + ρF B − B; tracked from round to round.
    missing: Vec<Rgb>,
    /// The light that the Krylov space began with, and the space, if there is to be one.
    krylov: Option<(Vec<Rgb>, Space)>,
}

impl<'a> GroupSolver<'a> {
    /// Prepare what the method needs for a group.
    pub fn new(group: &'a Group<'a>, method: Method, goal: Goal, spent: &mut Overhead) -> Self {
        let count = group.members.len();
        let krylov = matches!(method, Method::Auto | Method::Gmres) && count > 1;
        let wanted = method == Method::Gmres
            || pays(group.systems().map(|system| system.answers.returned), goal.error);
        let coarse = timed(&mut spent.coarse, || if krylov && wanted { Coarse::of(group) } else { None });
        let turns = match method {
            Method::Jacobi => 1,
            Method::GaussSeidel => count,
            Method::Auto | Method::Gmres => TURNS,
        };
        let margin = timed(&mut spent.margin, || Margin::of(group, coarse.as_ref(), TURNS));
        let columns = timed(&mut spent.account, || Columns::of(group));
        let sweep = BlockCorrection::new(group, turns, krylov.then_some(ROUGH));
        Self { group, coarse, margin, columns, sweep, krylov }
    }

    /// Least and largest column sum.
    pub fn column_sums(&self) -> [f64; 2] {
        self.columns.range()
    }

    /// Rounds from `start`, or from darkness, until the goal is met, no progress is possible, or somebody stops it.
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
        let is_last = |rounds: usize| rounds >= goal.rounds || monitor.stopped() || listener.ends_exchange();
        let mut converged = is_warm && estimate.is_within(goal.error);
        let mut rounds: Vec<GroupRound> = Vec::new();
        let mut proved_before = f64::INFINITY;
        let mut ends = converged || is_last(0);
        while !ends {
            let start = Instant::now();
            self.advance(&mut state, times);
            estimate = self.estimate(&state, times);
            let settled = estimate.is_rounded() || state.is_full();
            ends = is_last(rounds.len() + 1);
            if estimate.is_within(goal.error) || settled || ends {
                // What was tracked from round to round is computed anew before anything is said to be proved.
                timed(&mut times.overhead.proving, || self.refresh(&mut state));
                estimate = self.estimate(&state, times);
                let stalled = settled && estimate.relative_bound() > 0.5 * proved_before;
                proved_before = estimate.relative_bound();
                // All that rounding allows is what an error of zero asks for.
                converged = estimate.is_within(goal.error) || (stalled && goal.error == 0.0);
                ends |= converged || stalled;
            }
            forget(&mut rounds);
            let radiosity = Some(state.radiosity.clone());
            rounds.push(GroupRound { estimate, time: start.elapsed(), radiosity });
            monitor.advance(1);
            let (number, convergence) = (rounds.len(), Convergence::default().with(&estimate));
            let (instances, radiosity) = (&self.group.members, &state.radiosity);
            listener.round(&FinishedRound {
                instances,
                number,
                convergence,
                times,
                is_last: ends,
                radiosity,
            });
        }
        if !(is_warm && rounds.is_empty()) {
            estimate.error_bound = self.sharp_bound(&state, times);
        }
        look_back(&mut rounds, estimate, &state.radiosity);
        let waiting = self.group.waiting_irradiance(&state.radiosity);
        GroupOutcome {
            irradiance: sum(&state.irradiance, &waiting),
            radiosity: state.radiosity,
            rounds,
            estimate,
            converged,
            idle: self.sweep.idle,
            coarse: self.coarse.as_ref().map_or(0, Coarse::unknowns),
        }
    }

    fn begin(&self, start: Option<Vec<Rgb>>) -> SolverState {
        let dark = || vec![Rgb::BLACK; self.group.elements()];
        let irradiance = start.as_ref().map_or_else(dark, |start| self.group.irradiance(start));
        let radiosity = start.unwrap_or_else(dark);
        let missing = self.group.residual(&radiosity, &irradiance);
        let krylov = self.krylov.then(|| (radiosity.clone(), Space::new(&missing)));
        SolverState { radiosity, irradiance, missing, krylov }
    }

    /// One round: a correction, and what is still missing then.
    fn advance(&mut self, state: &mut SolverState, times: &mut StepTimes) {
        let Some((base, space)) = &mut state.krylov else {
            let (z, az) = self.sweep.correct(&state.missing, None, times);
            state.radiosity = sum(&state.radiosity, &z);
            state.missing = state.missing.iter().zip(az).map(|(&r, az)| r - az).collect();
            return;
        };
        let coarse = || self.coarse.as_ref().and_then(|coarse| coarse.correct(space.newest()));
        let start = timed(&mut times.overhead.krylov, coarse);
        let (z, az) = self.sweep.correct(space.newest(), start, times);
        timed(&mut times.overhead.krylov, || {
            space.add(z, az);
            state.radiosity = sum(base, &space.correction());
            state.missing = space.residual();
        });
    }

    /// Compute from the radiosity alone what is missing.
    fn refresh(&self, state: &mut SolverState) {
        state.irradiance = self.group.irradiance(&state.radiosity);
        state.missing = self.group.residual(&state.radiosity, &state.irradiance);
        state.krylov = self.krylov.then(|| (state.radiosity.clone(), Space::new(&state.missing)));
    }

    fn estimate(&self, state: &SolverState, times: &mut StepTimes) -> ErrorEstimate {
        timed(&mut times.overhead.judging, || ErrorEstimate {
            residual: largest(&state.missing),
            error_bound: self.margin.bound(&state.missing, &state.radiosity),
            brightest: largest(&state.radiosity),
            energy: self.columns.account(self.group, &state.radiosity, &state.missing),
        })
    }

    fn sharp_bound(&self, state: &SolverState, times: &mut StepTimes) -> Rgb {
        let bound = || self.margin.sharp_bound(self.group, &state.missing, &state.radiosity);
        timed(&mut times.overhead.proving, bound)
    }
}

impl SolverState {
    fn is_full(&self) -> bool {
        self.krylov.as_ref().is_some_and(|(_, space)| space.is_full())
    }
}

/// Drop the light of the last round if it is not to be shown: another follows.
fn forget(rounds: &mut [GroupRound]) {
    let number = rounds.len();
    if let Some(last) = rounds.last_mut().filter(|_| !is_shown(number)) {
        last.radiosity = None;
    }
}

/// The last round gets what is known of its light in the end. Later light tells how far earlier light was off:
/// |B − B_n| ≤ |B − B_N| + |B_N − B_n|.
fn look_back(rounds: &mut [GroupRound], estimate: ErrorEstimate, light: &[Rgb]) {
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
