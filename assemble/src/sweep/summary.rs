//! The results of a sweep, as `sweep.json` has them: one row for each run with its costs and errors, the front, the
//! cheapest settings, and conclusions.

use super::findings::findings;
use super::front::front;
use super::reference::Reference;
use super::row::{Compared, Row};
use super::run::{Round, Run};
use super::separation::{Separated, separated};
use super::setting::{Kind, Setting, Skipped};
use serde::Serialize;

/// The results of a sweep.
#[derive(Debug, Clone, Serialize)]
pub struct Summary {
    /// The scene's name.
    pub scene: String,
    /// The reference that runs are compared with.
    pub reference: Compared,
    /// The element size that the scene gets by default, metres.
    pub default_element_size: f64,
    /// The runs, in the order in which they were started.
    pub runs: Vec<Row>,
    /// For some target errors the quickest setting of parts that reaches it.
    pub cheapest: Vec<Cheapest>,
    /// Errors by source.
    pub separated: Vec<Separated>,
    /// Exchanges round by round, each with the command.
    pub exchanges: Vec<Exchange>,
    /// Conclusions, one sentence each.
    pub findings: Vec<String>,
    /// Settings that were not run and why, one sentence each.
    pub skipped: Vec<String>,
    /// The number of runs kept from an earlier sweep.
    pub reused: usize,
    /// Wall time of this sweep.
    pub seconds: f64,
}

/// The quickest settings for a target error, as indices of rows.
#[derive(Debug, Clone, Serialize)]
pub struct Cheapest {
    /// The error, as a share of the mean.
    pub error: f64,
    /// The run with this error of light at points.
    pub gathered: Option<usize>,
    /// The run with this error of light on elements.
    pub elements: Option<usize>,
}

/// An exchange round by round.
#[derive(Debug, Clone, Serialize)]
pub struct Exchange {
    /// Its name.
    pub label: String,
    /// The command line.
    pub command: String,
    /// Proved and true errors, W/m².
    pub rounds: Vec<Round>,
}

/// The target errors.
const TARGETS: [f64; 3] = [0.05, 0.02, 0.01];

/// The runs of a sweep, and what it skipped.
pub(super) struct Found<'a> {
    /// The scene's name.
    pub scene: &'a str,
    /// Its element size by default, metres.
    pub size: f64,
    /// Runs.
    pub runs: &'a [Run],
    /// The number of these that were kept from an earlier sweep.
    pub reused: usize,
    /// The settings that were not run.
    pub skipped: &'a [Skipped],
    /// Wall time.
    pub seconds: f64,
    /// The command line of a setting.
    pub commands: &'a dyn Fn(&Setting) -> String,
}

impl Summary {
    /// Of all runs, compared with the reference.
    pub(super) fn of(found: &Found, reference: &Reference, compared: Compared) -> Self {
        let mut runs: Vec<Row> = found
            .runs
            .iter()
            .filter(|run| !matches!(run.setting.kind, Kind::Verified { .. }))
            .map(|run| Row::of(run, found.size, reference, &compared))
            .collect();
        for (row, on) in on_front(&runs, Row::gathered).into_iter().enumerate() {
            runs[row].on_gathered_front = on;
        }
        for (row, on) in on_front(&runs, Row::flat).into_iter().enumerate() {
            runs[row].on_elements_front = on;
        }
        let cheapest = TARGETS.map(|error| Cheapest {
            error,
            gathered: quickest(&runs, error, Row::gathered),
            elements: quickest(&runs, error, Row::flat),
        });
        let skipped = found.skipped.iter().map(|s| format!("{}: {}", (found.commands)(&s.setting), s.why));
        Self {
            scene: found.scene.to_owned(),
            default_element_size: found.size,
            cheapest: cheapest.into(),
            separated: separated(found.runs, reference),
            exchanges: exchanges(found.runs),
            findings: findings(found.runs, &runs, found.size),
            skipped: skipped.collect(),
            reused: found.reused,
            seconds: found.seconds,
            reference: compared,
            runs,
        }
    }
}

/// Which rows are on the front of this cost and error.
fn on_front(rows: &[Row], of: impl Fn(&Row) -> (f64, f64)) -> Vec<bool> {
    let none = (f64::NAN, f64::NAN);
    let choices: Vec<(f64, f64)> =
        rows.iter().map(|row| if row.competes() { of(row) } else { none }).collect();
    let chosen = front(&choices);
    (0..rows.len()).map(|row| chosen.contains(&row)).collect()
}

/// The quickest competing row with at most this error.
fn quickest(rows: &[Row], error: f64, of: impl Fn(&Row) -> (f64, f64)) -> Option<usize> {
    let good = |&row: &usize| rows[row].competes() && of(&rows[row]).1 <= error;
    (0..rows.len()).filter(good).min_by(|&a, &b| of(&rows[a]).0.total_cmp(&of(&rows[b]).0))
}

fn exchanges(runs: &[Run]) -> Vec<Exchange> {
    let verified = runs.iter().filter(|run| matches!(run.setting.kind, Kind::Verified { .. }));
    let exchange = |run: &Run| Exchange {
        label: run.setting.more.last().cloned().unwrap_or_default(),
        command: run.command.clone(),
        rounds: run.facts.rounds.clone(),
    };
    verified.map(exchange).collect()
}
