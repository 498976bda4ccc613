//! Combines the outcomes of all groups into the outcome of the scene, whose rounds count the rounds of all groups
//! together.

use crate::exchange::error_estimate::ErrorEstimate;
use crate::exchange::group_solver::GroupOutcome;
use crate::exchange::groups::ranges;
use crate::exchange::outcome::{Convergence, Outcome, Round, SkippedWork, is_shown};
use crate::exchange::step_times::StepTimes;
use crate::exchange::system::InstanceSystem;
use equilux_formats::Rgb;
use std::ops::Range;

/// Accumulates the outcomes of groups.
pub struct SceneOutcome {
    /// The range of each instance's elements among all elements.
    places: Vec<Range<usize>>,
    solved: Vec<(Vec<usize>, GroupOutcome)>,
    column_sums: [f64; 2],
    /// Work that was skipped.
    pub skipped: SkippedWork,
}

impl SceneOutcome {
    /// An empty accumulator.
    pub fn new(systems: &[InstanceSystem]) -> Self {
        Self {
            places: ranges(systems.iter().map(|system| system.areas.len())),
            solved: vec![],
            column_sums: [f64::INFINITY, 0.0],
            skipped: SkippedWork::default(),
        }
    }

    /// Add the outcome of a group with these instances.
    pub fn add(&mut self, members: &[usize], [low, high]: [f64; 2], outcome: GroupOutcome) {
        self.column_sums = [self.column_sums[0].min(low), self.column_sums[1].max(high)];
        self.skipped.dark_solves += outcome.idle;
        self.solved.push((members.to_vec(), outcome));
    }

    /// The outcome of the scene.
    pub fn outcome(self, times: StepTimes) -> Outcome {
        let outcomes = || self.solved.iter().map(|(_, outcome)| outcome);
        let count = outcomes().map(|outcome| outcome.rounds.len()).max().unwrap_or(0);
        Outcome {
            radiosity: self.joined(|outcome| &outcome.radiosity),
            irradiance: self.joined(|outcome| &outcome.irradiance),
            rounds: (1..=count).map(|number| self.round(number, number == count)).collect(),
            convergence: self.convergence(|outcome| &outcome.estimate),
            times,
            converged: outcomes().all(|outcome| outcome.converged),
            skipped: self.skipped,
            coarse_unknowns: outcomes().map(|outcome| outcome.coarse).sum(),
            groups: self.solved.len(),
            column_sums: self.column_sums,
        }
    }

    /// The `number`th round of all groups; a group that has ended keeps its last state.
    fn round(&self, number: usize, is_last: bool) -> Round {
        let rounds = self.solved.iter().filter_map(|(_, outcome)| outcome.rounds.get(number - 1));
        let light = (is_last || is_shown(number)).then(|| {
            self.joined(|outcome| {
                let round = outcome.rounds.get(number - 1);
                round.and_then(|round| round.radiosity.as_ref()).unwrap_or(&outcome.radiosity)
            })
        });
        Round {
            number,
            convergence: self.convergence(|outcome| {
                outcome.rounds.get(number - 1).map_or(&outcome.estimate, |r| &r.estimate)
            }),
            time: rounds.map(|round| round.time).sum(),
            radiosity: light,
        }
    }

    fn convergence<'a>(&'a self, of: impl Fn(&'a GroupOutcome) -> &'a ErrorEstimate) -> Convergence {
        self.solved
            .iter()
            .fold(Convergence::default(), |convergence, (_, outcome)| convergence.with(of(outcome)))
    }

    /// One vector of the scene from one vector of each group.
    fn joined<'a>(&'a self, of: impl Fn(&'a GroupOutcome) -> &'a Vec<Rgb>) -> Vec<Rgb> {
        let mut all = vec![Rgb::BLACK; self.places.last().map_or(0, |last| last.end)];
        for (members, outcome) in &self.solved {
            let mut rest = of(outcome).as_slice();
            for &member in members {
                let (own, others) = rest.split_at(self.places[member].len());
                all[self.places[member].clone()].copy_from_slice(own);
                rest = others;
            }
        }
        all
    }
}
