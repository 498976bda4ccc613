//! Whoever watches a run while it goes on. In go the run's results as they come; out comes at most the wish that the
//! exchange ends.

use crate::coupling::Coupled;
use crate::exchange::{Known, Outcome, StepTimes};
use crate::placed::Placed;
use equilux_bake::oven::Baked;
use equilux_bake::oven::prepare::Prepared;
use equilux_formats::{Camera, Optics, Rgb, Scene};

/// Sees a run go on. The run waits while it is told: take a copy of what is wanted, and return.
pub trait Observer: Sync {
    /// The scene's parts have elements; nothing is computed yet.
    fn prepared(&self, _scene: &Scene, _prepared: &Prepared) {}
    /// A part, by its number, has its form factors and its own light.
    fn baked(&self, _number: usize, _part: &Baked) {}
    /// All parts are in their places.
    fn placed(&self, _placed: &Placed, _cameras: &[Camera]) {}
    /// An instance has its coupling.
    fn coupled(&self, _instance: usize, _coupled: &Coupled) {}
    /// All form factors are there, and the exchange begins. `optics` are those of all elements.
    fn coupled_all(&self, _placed: &Placed, _coupled: &[Coupled], _optics: &Optics) {}
    /// A round has passed.
    fn round(&self, _passed: &Passed) {}
    /// Whether the light is good enough: the exchange then ends after the round.
    fn enough(&self) -> bool {
        false
    }
    /// The exchange is over, and the irradiance of all elements is known; outputs follow.
    fn settled(&self, _outcome: &Outcome) {}
}

/// A round of some of a scene's instances.
pub struct Passed<'a> {
    /// Who took part, in order.
    pub instances: &'a [usize],
    /// 1 for the first round of these instances.
    pub number: usize,
    /// What is known of their light after it.
    pub known: Known,
    /// Time spent so far, all rounds together.
    pub times: &'a StepTimes,
    /// Whether it was their last.
    pub is_last: bool,
    /// Radiosity of their elements, W/m², one instance after the other.
    pub radiosity: &'a [Rgb],
}

/// Nobody.
pub struct Unobserved;

impl Observer for Unobserved {}
