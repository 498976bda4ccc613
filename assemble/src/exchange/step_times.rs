//! Time spent in the steps of an exchange.

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

/// Wall time of the exchange outside the paper's steps.
#[derive(Debug, Clone, Copy, Default)]
pub struct Overhead {
    /// Finding groups of parts, and the column sums of the power balance; once.
    pub account: Duration,
    /// Setting up the coarse space; once.
    pub coarse: Duration,
    /// Computing the margin of the error bound; once.
    pub margin: Duration,
    /// Coarse corrections and the Krylov space; all rounds.
    pub krylov: Duration,
    /// Bounds and power balances; all rounds.
    pub estimates: Duration,
    /// Recomputed residuals, and the final, sharper bound.
    pub proof: Duration,
}

impl Overhead {
    /// The sum.
    pub fn total(&self) -> Duration {
        self.account + self.coarse + self.margin + self.krylov + self.estimates + self.proof
    }
}

impl StepTimes {
    /// Zero times for this many instances.
    pub fn none(instances: usize) -> Self {
        let none = vec![Duration::ZERO; instances];
        Self { solve: none.clone(), transfer: none, overhead: Overhead::default() }
    }
}

/// Run `work` and add its wall time to `total`.
pub fn timed<T>(total: &mut Duration, work: impl FnOnce() -> T) -> T {
    let start = Instant::now();
    let done = work();
    *total += start.elapsed();
    done
}
