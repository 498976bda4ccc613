//! The trials of a sweep: which runs of the grid fit into the budget of time and into memory, which are done, and which
//! were skipped and why.

use super::forecast::{forecast, matrix_bytes, memory_available};
use super::grid::{SIZES, grid, metres};
use super::process::{Ended, Runner};
use super::reference::Reference;
use super::row::Compared;
use super::run::Run;
use super::setting::{Kind, Setting, Skipped};
use equilux_bake::elements::ElementSize;
use equilux_bake::oven::prepare::{Division, Preparation, RowMethod, prepare};
use equilux_bake::treecode::EXACT;
use equilux_formats::{Error, Result, Scene};
use std::time::{Duration, Instant};

/// The share of the budget that may be spent on a reference.
const FOR_REFERENCE: f64 = 1.0 / 3.0;

/// The share of the memory available that a matrix may take.
const FOR_MATRIX: f64 = 0.5;

/// The share of the budget that one classic run may take; these are for comparison only.
const FOR_CLASSIC: f64 = 0.05;

/// Runs of one scene with different settings, within a budget of time.
pub struct Trials<'a> {
    /// Runs a setting in a process of its own.
    pub runner: Runner<'a>,
    scene: &'a Scene,
    start: Instant,
    budget: Duration,
    /// The runs that are complete.
    pub done: Vec<Run>,
    /// The number of these that were kept from an earlier sweep.
    pub reused: usize,
    /// The settings that were not run.
    pub skipped: Vec<Skipped>,
    /// Element sizes, metres, and the number of elements of that size in the scene.
    counted: Vec<(f64, usize)>,
}

impl<'a> Trials<'a> {
    /// None as yet. The budget of time begins at `start`.
    pub fn new(runner: Runner<'a>, scene: &'a Scene, start: Instant, budget: Duration) -> Self {
        let (done, skipped, counted) = (vec![], vec![], vec![]);
        // The work of a sweep is its budget, in seconds.
        runner.monitor.expect(budget.as_secs_f64());
        Self { runner, scene, start, budget, done, reused: 0, skipped, counted }
    }

    /// The light at points of the finest exact run that fits into its share of the budget. Fails if not even one run ends.
    pub fn find_reference(&mut self, size: f64) -> Result<(Reference, Compared)> {
        let mut ladder: Vec<Run> = vec![];
        for factor in SIZES.into_iter().chain([0.25]) {
            let setting = Setting::new(Kind::Parts { tolerance: 0.0 }, metres(size * factor));
            let may_take = self.budget.mul_f64(FOR_REFERENCE).saturating_sub(self.start.elapsed());
            match self.attempt(&setting, may_take)? {
                Some(run) => ladder.push(run),
                None => break,
            }
        }
        let Some(finest) = ladder.last() else {
            let (found, remedy) = match self.skipped.first() {
                Some(skipped) => (
                    format!("no run was complete; the first: {}", skipped.why),
                    "give more time with --budget SECONDS, or a reference with --truth FILE.csv",
                ),
                None => {
                    ("stopped before the first run was complete".to_owned(), "run the same command again")
                }
            };
            return Err(Error::new(&self.scene.file, found, "at least one run to compare with", remedy));
        };
        self.skipped.clear();
        let reference = Reference::of(finest);
        let coarser = ladder.len().checked_sub(2).map(|k| &ladder[k]);
        Ok((reference.clone(), Compared::with_run(finest, coarser, &reference)))
    }

    /// Run all settings that fit into the time left.
    pub fn try_all(&mut self, size: f64) -> Result<()> {
        for setting in grid(size) {
            if self.runner.monitor.stopped() {
                break;
            }
            if self.done.iter().any(|run| run.setting == setting) {
                continue;
            }
            let left = self.budget.saturating_sub(self.start.elapsed());
            let most = if setting.is_classic() { self.budget.mul_f64(FOR_CLASSIC) } else { left };
            self.attempt(&setting, left.min(most))?;
        }
        Ok(())
    }

    /// The run of a setting, kept or new; none if it is expected to take more than `may_take`, or did not end well.
    fn attempt(&mut self, setting: &Setting, may_take: Duration) -> Result<Option<Run>> {
        if let Some(run) = self.runner.kept(setting) {
            self.reused += 1;
            self.done.push(run.clone());
            return Ok(Some(run));
        }
        let elements = self.count(setting.element_size)?;
        let seconds = forecast(setting, elements, &self.done);
        if seconds > may_take.as_secs_f64() {
            self.skip(
                setting,
                format!(
                    "it is expected to take {seconds:.1} s, more than the {:.1} s left for it",
                    may_take.as_secs_f64()
                ),
            );
            return Ok(None);
        }
        let bytes = matrix_bytes(setting.kind, elements).unwrap_or(0.0);
        if memory_available().is_some_and(|available| bytes > FOR_MATRIX * available) {
            self.skip(
                setting,
                format!("its matrix takes {:.1} GB, more than half of the memory available", bytes / 1e9),
            );
            return Ok(None);
        }
        match self.run(setting, seconds)? {
            Ended::Done(run) => {
                self.done.push((*run).clone());
                return Ok(Some(*run));
            }
            Ended::Failed(said) => self.skip(setting, format!("it failed: {said}")),
            Ended::TimeUp => self.skip(setting, "it did not end before the budget was spent".into()),
            Ended::Stopped => {}
        }
        Ok(None)
    }

    /// Run a setting that is expected to take so many seconds, as progress of the sweep.
    fn run(&self, setting: &Setting, seconds: f64) -> Result<Ended> {
        let what = format!("run {} ({})", self.done.len() + 1, setting.label());
        let monitor = self.runner.monitor;
        monitor.begin(what, (seconds * 10.0).ceil() as usize, seconds);
        let start = Instant::now();
        let ended = self.runner.run(setting);
        // The budget is spent by what the run took, not by what was expected.
        monitor.spare(start.elapsed().as_secs_f64() - seconds);
        ended
    }

    /// The number of elements of that size, metres, in the scene.
    fn count(&mut self, size: f64) -> Result<usize> {
        if let Some((_, elements)) = self.counted.iter().find(|(known, _)| *known == size) {
            return Ok(*elements);
        }
        let elements = elements_of(self.scene, size)?;
        self.counted.push((size, elements));
        Ok(elements)
    }

    fn skip(&mut self, setting: &Setting, why: String) {
        self.skipped.push(Skipped { setting: setting.clone(), why });
    }
}

fn preparation(element_size: Option<ElementSize>) -> Preparation {
    Preparation {
        element_size,
        division: Division::Authored,
        resolution: EXACT,
        rows: RowMethod::Exact,
        rays: 256,
        local_solver: None,
    }
}

/// The element size that the scene gets by default, metres.
pub fn default_size(scene: &Scene) -> Result<f64> {
    match prepare(scene, &preparation(None))?.element_size {
        ElementSize::Metres(size) => Ok(size),
        ElementSize::Mesh => Ok(1.0),
    }
}

/// The number of elements of that size, metres, in the scene.
fn elements_of(scene: &Scene, size: f64) -> Result<usize> {
    let prepared = prepare(scene, &preparation(Some(ElementSize::Metres(size))))?;
    Ok(prepared.elements())
}
