//! What looks wrong in a scene or in its light: results of a run → sentences that say what to change.

mod backs;
mod balance;
mod overfull;
mod view;

use crate::exchange::outcome::Outcome;
use crate::exchange::system::InstanceSystem;
use crate::placed_parts::PlacedParts;
use view::View;

/// Sentences about rows above one, energy that does not add up, and surfaces that show their black backs.
pub fn checks(placed: &PlacedParts, systems: &[InstanceSystem], outcome: &Outcome) -> Vec<String> {
    let view = View::of(placed);
    let overfull = overfull::notes(placed, systems, &view);
    let balance = balance::note(placed, systems, outcome, &view);
    overfull.into_iter().chain(balance).chain(backs::notes(placed, &view)).collect()
}
