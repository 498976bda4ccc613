//! The light of all groups of parts together. In go the outcomes of the groups; out comes that of the scene, its rounds
//! those of all groups counted together.

use super::groups::ranges;
use super::rounds::{GroupOutcome, Judged};
use super::{Known, Node, Outcome, Round, Spared, StepTimes, is_shown};
use equilux_formats::Rgb;
use std::ops::Range;

/// What is gathered from group to group.
pub struct Whole {
    /// Where each instance's elements lie among all.
    places: Vec<Range<usize>>,
    solved: Vec<(Vec<usize>, GroupOutcome)>,
    column_sums: [f64; 2],
    /// What was left out.
    pub spared: Spared,
}

impl Whole {
    /// No group yet.
    pub fn new(nodes: &[Node]) -> Self {
        Self {
            places: ranges(nodes.iter().map(|node| node.areas.len())),
            solved: vec![],
            column_sums: [f64::INFINITY, 0.0],
            spared: Spared::default(),
        }
    }

    /// Take in the outcome of a group with these instances.
    pub fn take(&mut self, members: &[usize], [low, high]: [f64; 2], outcome: GroupOutcome) {
        self.column_sums = [self.column_sums[0].min(low), self.column_sums[1].max(high)];
        self.spared.dark_solves += outcome.idle;
        self.solved.push((members.to_vec(), outcome));
    }

    /// All of it.
    pub fn outcome(self, times: StepTimes) -> Outcome {
        let outcomes = || self.solved.iter().map(|(_, outcome)| outcome);
        let count = outcomes().map(|outcome| outcome.rounds.len()).max().unwrap_or(0);
        Outcome {
            radiosity: self.joined(|outcome| &outcome.radiosity),
            irradiance: self.joined(|outcome| &outcome.irradiance),
            rounds: (1..=count).map(|number| self.round(number, number == count)).collect(),
            known: self.known(|outcome| &outcome.judged),
            times,
            converged: outcomes().all(|outcome| outcome.converged),
            spared: self.spared,
            coarse_unknowns: outcomes().map(|outcome| outcome.coarse).sum(),
            groups: self.solved.len(),
            column_sums: self.column_sums,
        }
    }

    /// The `number`th round of all groups; a group that has ended stays as it is.
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
            known: self
                .known(|outcome| outcome.rounds.get(number - 1).map_or(&outcome.judged, |r| &r.judged)),
            time: rounds.map(|round| round.time).sum(),
            radiosity: light,
        }
    }

    fn known<'a>(&'a self, of: impl Fn(&'a GroupOutcome) -> &'a Judged) -> Known {
        self.solved.iter().fold(Known::default(), |known, (_, outcome)| known.with(of(outcome)))
    }

    /// One vector of the scene from one of each group.
    fn joined<'a>(&'a self, of: impl Fn(&'a GroupOutcome) -> &'a Vec<Rgb>) -> Vec<Rgb> {
        let mut all = vec![[0.0; 3]; self.places.last().map_or(0, |last| last.end)];
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
