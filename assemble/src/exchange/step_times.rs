//! Where the time of an exchange goes.

use std::time::{Duration, Instant};

/// Time spent in the paper's steps 5 and 6 (local solves) and 7 and 8 (transfers), one entry an instance.
#[derive(Debug, Clone, Default)]
pub struct StepTimes {
    /// Equilibrium inside each instance.
    pub solve: Vec<Duration>,
    /// Transfer into each instance.
    pub transfer: Vec<Duration>,
    /// Everything else.
    pub overhead: Overhead,
}

/// Wall time of what the exchange does beside the paper's steps.
#[derive(Debug, Clone, Copy, Default)]
pub struct Overhead {
    /// Finding groups of parts, and the column sums of the energy account; once.
    pub account: Duration,
    /// Setting up the coarse space; once.
    pub coarse: Duration,
    /// Finding the vector that the bound needs; once.
    pub margin: Duration,
    /// Coarse corrections and the Krylov space; all rounds.
    pub krylov: Duration,
    /// Bounds and energy accounts; all rounds.
    pub judging: Duration,
    /// Residuals computed anew, and the last, sharper bound.
    pub proving: Duration,
}

impl Overhead {
    /// All of it.
    pub fn total(&self) -> Duration {
        self.account + self.coarse + self.margin + self.krylov + self.judging + self.proving
    }
}

impl StepTimes {
    /// No time in so many instances.
    pub fn none(instances: usize) -> Self {
        let none = vec![Duration::ZERO; instances];
        Self { solve: none.clone(), transfer: none, overhead: Overhead::default() }
    }
}

/// Do some work and add the time it takes to `total`.
pub fn timed<T>(total: &mut Duration, work: impl FnOnce() -> T) -> T {
    let start = Instant::now();
    let done = work();
    *total += start.elapsed();
    done
}
