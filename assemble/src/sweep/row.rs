//! One run as the report shows it: what it computed, what it cost and how large its errors are; and the reference that
//! the errors refer to.

use super::errors::Errors;
use super::reference::Reference;
use super::run::Run;
use super::setting::Setting;
use crate::report::Seconds;
use serde::Serialize;
use std::path::Path;

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

impl Row {
    /// Of a run, with `size` the scene's own element size, metres; on no front as yet.
    pub fn of(run: &Run, size: f64, reference: &Reference, compared: &Compared) -> Self {
        let facts = &run.facts;
        Self {
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
