//! Checks for probable errors in a scene or its light. Input: the results of a run. Output: notes that say what to
//! change.

mod backs;
mod balance;
mod overfull;
mod ray_sample;

use crate::exchange::outcome::Outcome;
use crate::exchange::system::InstanceSystem;
use crate::placed_parts::PlacedParts;
use ray_sample::RaySample;

/// Notes on rows that sum to more than one, on power that does not balance, and on surfaces that show their black
/// backs.
pub fn checks(placed: &PlacedParts, systems: &[InstanceSystem], outcome: &Outcome) -> Vec<String> {
    let rays = RaySample::of(placed);
    let overfull = overfull::notes(placed, systems, &rays);
    let balance = balance::note(placed, systems, outcome, &rays);
    overfull.into_iter().chain(balance).chain(backs::notes(placed, &rays)).collect()
}
