//! The present stage of a run, its progress, and whether it is to stop. Shared between the threads that compute and the
//! one that shows progress.

use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

/// Progress of long work, and the wish to end it.
#[derive(Default)]
pub struct Monitor {
    stage: Mutex<Stage>,
    done: AtomicU64,
    stopped: AtomicBool,
}

/// A named piece of work of known size.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Stage {
    /// What is being done, for a person.
    pub what: String,
    /// How many steps it has.
    pub total: u64,
}

impl Monitor {
    /// Begin a stage of `total` steps.
    pub fn begin(&self, what: impl Into<String>, total: usize) {
        *self.stage.lock().unwrap_or_else(|e| e.into_inner()) =
            Stage { what: what.into(), total: total as u64 };
        self.done.store(0, Ordering::Relaxed);
    }

    /// Count steps as done.
    pub fn advance(&self, steps: usize) {
        self.done.fetch_add(steps as u64, Ordering::Relaxed);
    }

    /// The current stage and the steps done in it.
    pub fn now(&self) -> (Stage, u64) {
        let stage = self.stage.lock().unwrap_or_else(|e| e.into_inner()).clone();
        (stage, self.done.load(Ordering::Relaxed))
    }

    /// Ask for an end: work stops at the next point where its results are whole.
    pub fn stop(&self) {
        self.stopped.store(true, Ordering::Relaxed);
    }

    /// Whether the run is to stop.
    pub fn stopped(&self) -> bool {
        self.stopped.load(Ordering::Relaxed)
    }
}
