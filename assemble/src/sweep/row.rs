//! One run as the report shows it: what it computed, what it cost and how large its errors are; and the reference that
//! the errors refer to.

use super::errors::Errors;
use super::reference::Reference;
use super::run::Run;
use super::setting::Setting;
use crate::report::seconds::Seconds;
use serde::Serialize;
use std::path::Path;

/// What runs are compared with.
#[derive(Debug, Clone, Serialize)]
pub struct Compared {
    /// The reference in words.
    pub what: String,
    /// Number of points.
    pub points: usize,
    /// The error of the reference itself, as a share of the mean; none if unknown.
    pub own_error: Option<f64>,
    /// Errors below this cannot be told from zero.
    pub resolves: f64,
    /// The setting of the run that the reference is taken from, if any.
    #[serde(skip)]
    pub setting: Option<Setting>,
}

/// A run with its errors.
#[derive(Debug, Clone, Serialize)]
pub struct Row {
    /// The setting in words.
    pub label: String,
    /// The command line that repeats it.
    pub command: String,
    /// The setting.
    #[serde(flatten)]
    pub setting: Setting,
    /// Number of elements.
    pub elements: usize,
    /// Wall time from the file to the light of all elements.
    pub seconds_solve: f64,
    /// The same in processor time, if the system reports it.
    pub seconds_solve_cpu: Option<f64>,
    /// Wall time to gather light at the points.
    pub seconds_points: f64,
    /// The same in processor time, if the system reports it.
    pub seconds_points_cpu: Option<f64>,
    /// Wall time of the process.
    pub seconds_process: f64,
    /// Size of the stored form factors.
    pub bytes_stored: usize,
    /// Peak memory of the process.
    pub bytes_peak: Option<usize>,
    /// Rounds of the exchange.
    pub rounds: usize,
    /// Its errors.
    pub errors: Errors,
    /// On the front of error at points against seconds to solve and gather.
    pub on_gathered_front: bool,
    /// On the front of the error of elements against seconds to solve.
    pub on_elements_front: bool,
    /// Whether these are the default settings.
    pub is_default: bool,
    /// Whether the reference is taken from this run.
    pub is_reference: bool,
    /// The paper's steps.
    pub steps: Seconds,
}

impl Compared {
    /// A file of reference light.
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

    /// The finest run. The difference from the next coarser one estimates its own error.
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
            seconds_points_cpu: facts.seconds.points_cpu,
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

    /// Seconds to solve and to gather, by [`Row::clock`], and the error of light gathered at the points.
    pub fn gathered(&self) -> (f64, f64) {
        let seconds = match self.cpu() {
            Some((solve, points)) => solve + points,
            None => self.seconds_solve + self.seconds_points,
        };
        (seconds, self.errors.gathered)
    }

    /// Seconds to solve, by [`Row::clock`], and the error of light that is constant on each element.
    pub fn flat(&self) -> (f64, f64) {
        (self.cpu().map_or(self.seconds_solve, |(solve, _)| solve), self.errors.elements)
    }

    /// What the seconds of costs are: processor time of all threads where the system reports it, else wall time.
    pub fn clock(&self) -> &'static str {
        if self.cpu().is_some() { "CPU time" } else { "wall time" }
    }

    fn cpu(&self) -> Option<(f64, f64)> {
        self.seconds_solve_cpu.zip(self.seconds_points_cpu)
    }

    /// Whether it competes with the others: it is a run of parts, and not the reference, which has no error against itself.
    pub fn competes(&self) -> bool {
        self.setting.is_ours() && !self.is_reference
    }
}
