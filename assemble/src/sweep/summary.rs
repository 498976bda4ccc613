//! What a sweep found, as `sweep.json` has it: one row a run with its costs and errors, which of them are on the front, and
//! what follows from comparing them.

use super::findings::findings;
use super::front::front;
use super::reference::Reference;
use super::row::{Compared, Row};
use super::run::{Round, Run};
use super::separation::{Separated, separated};
use super::setting::{Kind, Setting, Skipped};
use serde::Serialize;

/// Everything.
#[derive(Debug, Clone, Serialize)]
pub struct Summary {
    /// The scene's name.
    pub scene: String,
    /// What runs are compared with.
    pub reference: Compared,
    /// The element size that the scene gets by default, metres.
    pub default_element_size: f64,
    /// The runs, in the order they were asked for.
    pub runs: Vec<Row>,
    /// For some errors the quickest of our settings that is no further off.
    pub cheapest: Vec<Cheapest>,
    /// Errors by where they come from.
    pub separated: Vec<Separated>,
    /// Exchanges round by round, each with the command.
    pub exchanges: Vec<Exchange>,
    /// What the scene did and did not need, one sentence each.
    pub findings: Vec<String>,
    /// What was not run and why, one sentence each.
    pub skipped: Vec<String>,
    /// Runs that were there from before.
    pub reused: usize,
    /// Wall time of this sweep.
    pub seconds: f64,
}

/// The quickest settings for an error.
#[derive(Debug, Clone, Serialize)]
pub struct Cheapest {
    /// The error, as a share of the mean.
    pub error: f64,
    /// The number of the run that gathers so well.
    pub gathered: Option<usize>,
    /// The number of the run whose elements are so good.
    pub elements: Option<usize>,
}

/// An exchange round by round.
#[derive(Debug, Clone, Serialize)]
pub struct Exchange {
    /// For a person.
    pub label: String,
    /// The command line.
    pub command: String,
    /// Proved and true, W/m².
    pub rounds: Vec<Round>,
}

/// The errors that settings are named for.
const TARGETS: [f64; 3] = [0.05, 0.02, 0.01];

/// What a sweep has done.
pub struct Found<'a> {
    /// The scene's name.
    pub scene: &'a str,
    /// Its own element size, metres.
    pub size: f64,
    /// Runs.
    pub runs: &'a [Run],
    /// How many of them were there.
    pub reused: usize,
    /// What was not run.
    pub skipped: &'a [Skipped],
    /// Wall time.
    pub seconds: f64,
    /// The command line of a setting.
    pub commands: &'a dyn Fn(&Setting) -> String,
}

impl Summary {
    /// Of all that was found.
    pub fn of(found: &Found, reference: &Reference, compared: Compared) -> Self {
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

/// Which of our rows are on the front of this cost and error.
fn on_front(rows: &[Row], of: impl Fn(&Row) -> (f64, f64)) -> Vec<bool> {
    let none = (f64::NAN, f64::NAN);
    let choices: Vec<(f64, f64)> =
        rows.iter().map(|row| if row.competes() { of(row) } else { none }).collect();
    let chosen = front(&choices);
    (0..rows.len()).map(|row| chosen.contains(&row)).collect()
}

/// The quickest of our rows that errs no more.
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
