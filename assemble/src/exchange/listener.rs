//! Callbacks for an exchange in progress. A callback may request that the exchange end early.

use crate::exchange::outcome::Convergence;
use crate::exchange::step_times::StepTimes;
use equilux_formats::Rgb;

/// Receives the rounds of an exchange. The exchange waits for each call: copy what is needed, and return.
pub trait Listener: Sync {
    /// A round has finished.
    fn round(&self, _finished: &FinishedRound) {}
    /// Whether the exchange should end after this round because the light is already accurate enough.
    fn ends_exchange(&self) -> bool {
        false
    }
}

/// A round of one group of instances.
#[derive(Debug)]
pub struct FinishedRound<'a> {
    /// The group's instances, in order.
    pub instances: &'a [usize],
    /// 1 for the first round of these instances.
    pub number: usize,
    /// Error and power balance after it.
    pub convergence: Convergence,
    /// Time spent so far in all rounds.
    pub times: &'a StepTimes,
    /// Whether it was the group's last round.
    pub is_last: bool,
    /// Radiosity of the instances' elements, W/m², one instance after the other.
    pub radiosity: &'a [Rgb],
}

/// Ignores every call.
#[derive(Debug)]
pub struct Unobserved;

impl Listener for Unobserved {}
