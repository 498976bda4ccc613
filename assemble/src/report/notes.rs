//! Notes on the placed parts: notes that call for action, and remarks that do not.

use crate::equation::coupling::Coupled;
use crate::equation::interpenetration;
use crate::exchange::outcome::Outcome;
use crate::exchange::system::InstanceSystem;
use crate::placed_parts::PlacedParts;
use crate::report::checks::checks;

/// Maximum number of remarks of one kind; more are combined into one.
const MAX_SINGLE_REMARKS: usize = 4;

/// Notes that call for action.
pub fn notes(placed: &PlacedParts, systems: &[InstanceSystem], outcome: &Outcome) -> Vec<String> {
    interpenetration::notes(placed).into_iter().chain(checks(placed, systems, outcome)).collect()
}

/// Remarks on parts inside other parts: a sentence each, or, if there are many, one sentence with the first of them
/// and a count.
pub fn remarks(placed: &PlacedParts, coupled: &[Coupled]) -> Vec<String> {
    let name = |k: usize| format!("`{}`", placed.instances[k].name);
    let corrected = coupled.iter().enumerate().filter_map(|(k, own)| Some((k, own.corrected.as_ref()?)));
    let inside: Vec<(String, bool)> = corrected
        .filter(|(_, own)| !own.intruders.is_empty())
        .map(|(k, own)| {
            let inside: Vec<String> = own.intruders.iter().map(|&i| name(i)).collect();
            (format!("inside {} is {}", name(k), inside.join(", ")), own.origin.is_reused())
        })
        .collect();
    if inside.len() <= MAX_SINGLE_REMARKS {
        let how = |reused| if reused { "reused from the cache, corrected" } else { "recomputed" };
        return inside
            .iter()
            .map(|(what, reused)| format!("{what}: its self block was {}", how(*reused)))
            .collect();
    }
    let named: Vec<&str> = inside.iter().take(MAX_SINGLE_REMARKS).map(|(what, _)| what.as_str()).collect();
    let (reused, more) =
        (inside.iter().filter(|(_, reused)| *reused).count(), inside.len() - MAX_SINGLE_REMARKS);
    vec![format!(
        "{}, and {more} more cases: of their self blocks {} were recomputed, {reused} were reused from the cache",
        named.join("; "),
        inside.len() - reused
    )]
}
