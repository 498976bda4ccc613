//! Sentences on the parts in their places: notes that call for action, and remarks that do not.

use crate::equation::coupling::Coupled;
use crate::equation::interpenetration;
use crate::exchange::outcome::Outcome;
use crate::exchange::system::InstanceSystem;
use crate::placed_parts::PlacedParts;
use crate::report::checks::checks;

/// More sentences of one kind than this are made one.
const FEW: usize = 4;

/// Sentences that call for action.
pub fn notes(placed: &PlacedParts, systems: &[InstanceSystem], outcome: &Outcome) -> Vec<String> {
    interpenetration::notes(placed).into_iter().chain(checks(placed, systems, outcome)).collect()
}

/// What stands inside what: a sentence each, or, of more than a few, how many and the first of them.
pub fn remarks(placed: &PlacedParts, coupled: &[Coupled]) -> Vec<String> {
    let name = |k: usize| format!("`{}`", placed.instances[k].name);
    let corrected = coupled.iter().enumerate().filter_map(|(k, own)| Some((k, own.corrected.as_ref()?)));
    let inside: Vec<(String, bool)> = corrected
        .map(|(k, own)| {
            let inside: Vec<String> = own.intruders.iter().map(|&i| name(i)).collect();
            (format!("inside {} is {}", name(k), inside.join(", ")), own.origin.is_reused())
        })
        .collect();
    if inside.len() <= FEW {
        let how = |reused| if reused { "taken corrected from the cache" } else { "computed anew" };
        return inside
            .iter()
            .map(|(what, reused)| format!("{what}: its own block was {}", how(*reused)))
            .collect();
    }
    let named: Vec<&str> = inside.iter().take(FEW).map(|(what, _)| what.as_str()).collect();
    let (reused, more) = (inside.iter().filter(|(_, reused)| *reused).count(), inside.len() - FEW);
    vec![format!(
        "{}, and so on in {more} more: of their own blocks {} were computed anew, {reused} taken corrected from the cache",
        named.join("; "),
        inside.len() - reused
    )]
}
