//! Progress of a run, and the request to stop it. Shared between the working threads and the one that shows progress.
//!
//! Work is measured in rows of form factors: those of the whole run, minus those that the cache provides, and those of
//! each step. The completed share and the remaining time of the whole run follow from these numbers.

use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::time::{Duration, Instant};

/// Progress of long work, and the request to stop it.
#[derive(Debug, Default)]
pub struct Monitor {
    work: Mutex<Work>,
    done: AtomicU64,
    stopped: AtomicBool,
}

/// A named step of known size.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Step {
    /// A description for the user.
    pub what: String,
    /// Its size in units of its own, such as receivers; 0 if it is not known.
    pub total: u64,
}

/// The work of the whole run, in rows.
#[derive(Debug, Default)]
struct Work {
    step: Step,
    /// The work of the current step.
    of_step: f64,
    /// The work of all steps before it.
    before: f64,
    /// The work of the whole run, as far as it is known.
    expected: f64,
    /// When the first step began.
    began: Option<Instant>,
}

/// How far a run is.
#[derive(Debug, Clone, PartialEq)]
pub struct Progress {
    /// The current step.
    pub step: Step,
    /// The completed units of the step.
    pub done: u64,
    /// The completed share of the whole run, 0 to 1.
    pub share: f64,
    /// The remaining time of the whole run at the present rate; none at the beginning.
    pub left: Option<Duration>,
}

/// The remaining time is estimated once this share of the work is done.
const FORETOLD_FROM: f64 = 0.02;

impl Monitor {
    /// Adds `rows` rows, or work of equal cost, to the expected work of the run.
    pub fn expect(&self, rows: f64) {
        self.work().expected += rows;
    }

    /// Subtracts `rows` rows that the cache provides.
    pub fn spare(&self, rows: f64) {
        self.work().expected -= rows;
    }

    /// Begins a step of `total` units (0 if unknown) that costs as much as `rows` rows, and completes the previous step.
    pub fn begin(&self, what: impl Into<String>, total: usize, rows: f64) {
        let mut work = self.work();
        work.step = Step { what: what.into(), total: total as u64 };
        work.before += work.of_step;
        work.of_step = rows;
        work.expected = work.expected.max(work.before + rows);
        work.began.get_or_insert_with(Instant::now);
        self.done.store(0, Ordering::Relaxed);
    }

    /// Counts `units` of the step as completed.
    pub fn advance(&self, units: usize) {
        self.done.fetch_add(units as u64, Ordering::Relaxed);
    }

    /// The progress of the run.
    pub fn now(&self) -> Progress {
        let work = self.work();
        let done = self.done.load(Ordering::Relaxed);
        let in_step = if work.step.total == 0 { 0.0 } else { done as f64 / work.step.total as f64 };
        let rows = work.before + work.of_step * in_step.min(1.0);
        let share = if work.expected > 0.0 { (rows / work.expected).clamp(0.0, 1.0) } else { 0.0 };
        let left = work.began.filter(|_| share >= FORETOLD_FROM);
        let left = left.map(|began| began.elapsed().mul_f64((1.0 - share) / share));
        Progress { step: work.step.clone(), done, share, left }
    }

    /// Requests a stop: work ends at the next point where its results are complete.
    pub fn stop(&self) {
        self.stopped.store(true, Ordering::Relaxed);
    }

    /// Whether a stop was requested.
    pub fn stopped(&self) -> bool {
        self.stopped.load(Ordering::Relaxed)
    }

    fn work(&self) -> std::sync::MutexGuard<'_, Work> {
        self.work.lock().unwrap_or_else(|poisoned| poisoned.into_inner())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn progress_is_that_of_the_whole_run() {
        let monitor = Monitor::default();
        monitor.expect(100.0);
        let share = || monitor.now().share;
        assert_eq!((share(), monitor.now().left), (0.0, None));
        monitor.begin("one", 10, 50.0);
        monitor.advance(5);
        assert_eq!(share(), 0.25);
        // The cache provides what was to be half of the rest; the next step then is all that is left.
        monitor.spare(25.0);
        monitor.begin("two", 0, 25.0);
        assert_eq!(share(), 50.0 / 75.0);
        assert!(monitor.now().left.is_some());
        // More than was expected makes no share above 1.
        monitor.begin("three", 1, 75.0);
        monitor.advance(1);
        assert_eq!(share(), 1.0);
    }
}
