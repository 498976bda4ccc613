//! Callbacks for a run in progress, from the first part to the light of all elements.

use crate::equation::coupling::Coupled;
use crate::exchange::listener::{Listener, Unobserved};
use crate::exchange::outcome::Outcome;
use crate::placed_parts::PlacedParts;
use equilux_bake::oven::Baked;
use equilux_bake::oven::prepare::Prepared;
use equilux_formats::{Camera, Optics, Rgb, Scene};

/// Receives the results of a run as they come. The run waits for each call: copy what is needed, and return.
pub trait Observer: Listener {
    /// The scene's parts have elements; nothing is computed yet.
    fn prepared(&self, _scene: &Scene, _prepared: &Prepared) {}
    /// The form factors and the own light of a part, by its number, are known.
    fn baked(&self, _number: usize, _part: &Baked) {}
    /// All parts are in their places.
    fn placed(&self, _placed: &PlacedParts, _cameras: &[Camera]) {}
    /// The coupling of an instance is known.
    fn coupled(&self, _instance: usize, _coupled: &Coupled) {}
    /// All form factors are known, and the exchange begins. `optics` are those of all elements.
    fn coupled_all(&self, _placed: &PlacedParts, _coupled: &[Coupled], _optics: &Optics) {}
    /// The exchange is over; outputs follow. `irradiance` of all elements, W/m², includes that of lamps, suns and sky.
    fn settled(&self, _outcome: &Outcome, _irradiance: &[Rgb]) {}
}

impl Observer for Unobserved {}
