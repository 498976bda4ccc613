//! What a sweep found, as `sweep.json` has it: one row a run with its costs and errors, which of them are on the front, and
//! what follows from comparing them.

use super::Skipped;
use super::errors::Errors;
use super::findings::findings;
use super::front::front;
use super::reference::Reference;
use super::run::{Round, Run};
use super::separation::{Separated, separated};
use super::setting::{Kind, Setting};
use crate::report::seconds::Seconds;
use serde::Serialize;
use std::path::Path;

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

/// What runs are compared with.
#[derive(Debug, Clone, Serialize)]
pub struct Compared {
    /// For a person.
    pub what: String,
    /// Number of points.
    pub points: usize,
    /// Its own error, as a share of the mean; none if unknown.
    pub own_error: Option<f64>,
    /// Errors below this cannot be told from none.
    pub resolves: f64,
    /// The setting of the run it comes from, if it does.
    #[serde(skip)]
    pub setting: Option<Setting>,
}

/// A run with its errors.
#[derive(Debug, Clone, Serialize)]
pub struct Row {
    /// For a person.
    pub label: String,
    /// The command line that gives it.
    pub command: String,
    /// What was asked for.
    #[serde(flatten)]
    pub setting: Setting,
    /// Number of elements.
    pub elements: usize,
    /// Wall time from the file to the light of all elements.
    pub seconds_solve: f64,
    /// The same in processor time, if the system tells.
    pub seconds_solve_cpu: Option<f64>,
    /// Wall time to gather light at the points.
    pub seconds_points: f64,
    /// Wall time of the process.
    pub seconds_process: f64,
    /// Form factors as they are kept.
    pub bytes_stored: usize,
    /// The most the process held.
    pub bytes_peak: Option<usize>,
    /// Rounds of the exchange.
    pub rounds: usize,
    /// Its errors.
    pub errors: Errors,
    /// On the front of error at points against seconds to solve and gather.
    pub on_gathered_front: bool,
    /// On the front of the error of elements against seconds to solve.
    pub on_elements_front: bool,
    /// Whether it is what a person gets without options.
    pub is_default: bool,
    /// Whether the reference comes from it.
    pub is_reference: bool,
    /// The paper's steps.
    pub steps: Seconds,
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

impl Compared {
    /// With a file.
    pub fn with_file(path: Option<&Path>, truth: &Reference) -> Self {
        let name = path.map(|path| path.display().to_string()).unwrap_or_default();
        Self {
            what: name,
            points: truth.areas.len(),
            own_error: Some(truth.noise_share()),
            resolves: truth.resolves(),
            setting: None,
        }
    }

    /// With the finest run, whose own error is told by the next coarser one.
    pub fn with_run(finest: &Run, coarser: Option<&Run>, reference: &Reference) -> Self {
        let own = coarser.map(|run| Errors::of(&run.light, reference).gathered);
        Self {
            what: format!(
                "the light that {} elements gather at the points ({})",
                finest.facts.elements,
                finest.setting.label()
            ),
            points: finest.light.len(),
            own_error: own,
            resolves: own.unwrap_or(0.0),
            setting: Some(finest.setting.clone()),
        }
    }
}

impl Summary {
    /// Of all that was found.
    pub fn of(found: &Found, reference: &Reference, compared: Compared) -> Self {
        let mut runs: Vec<Row> = found
            .runs
            .iter()
            .filter(|run| !matches!(run.setting.kind, Kind::Verified { .. }))
            .map(|run| row(run, found.size, reference, &compared))
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

impl Row {
    /// Seconds to solve and gather, and the error at the points.
    pub fn gathered(&self) -> Option<(f64, f64)> {
        Some((self.seconds_solve + self.seconds_points, self.errors.gathered))
    }

    /// Seconds to solve, and the error of flat elements.
    pub fn flat(&self) -> Option<(f64, f64)> {
        Some((self.seconds_solve, self.errors.elements))
    }

    /// Whether it competes with the others: the reference would win against itself.
    pub fn competes(&self) -> bool {
        self.setting.is_ours() && !self.is_reference
    }
}

fn row(run: &Run, size: f64, reference: &Reference, compared: &Compared) -> Row {
    let facts = &run.facts;
    Row {
        label: run.setting.label(),
        command: run.command.clone(),
        setting: run.setting.clone(),
        elements: facts.elements,
        seconds_solve: facts.seconds.solve,
        seconds_solve_cpu: facts.seconds.solve_cpu,
        seconds_points: facts.seconds.points,
        seconds_process: run.wall,
        bytes_stored: facts.bytes.stored,
        bytes_peak: facts.bytes.peak_rss,
        rounds: facts.rounds.len(),
        errors: Errors::of(&run.light, reference),
        on_gathered_front: false,
        on_elements_front: false,
        is_default: run.setting.is_default(size),
        is_reference: compared.setting.as_ref() == Some(&run.setting),
        steps: facts.seconds.clone(),
    }
}

/// Which of our rows are on the front of this cost and error.
fn on_front(rows: &[Row], of: impl Fn(&Row) -> Option<(f64, f64)>) -> Vec<bool> {
    let none = (f64::NAN, f64::NAN);
    let choices: Vec<(f64, f64)> =
        rows.iter().map(|row| of(row).filter(|_| row.competes()).unwrap_or(none)).collect();
    let chosen = front(&choices);
    (0..rows.len()).map(|row| chosen.contains(&row)).collect()
}

/// The quickest of our rows that errs no more.
fn quickest(rows: &[Row], error: f64, of: impl Fn(&Row) -> Option<(f64, f64)>) -> Option<usize> {
    let good = |&row: &usize| rows[row].competes() && of(&rows[row]).is_some_and(|(_, e)| e <= error);
    let seconds = |row: usize| of(&rows[row]).map_or(f64::INFINITY, |(seconds, _)| seconds);
    (0..rows.len()).filter(good).min_by(|&a, &b| seconds(a).total_cmp(&seconds(b)))
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
