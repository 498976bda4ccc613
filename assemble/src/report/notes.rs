//! Sentences on what a person should know of the parts in their places: what stands in what, and what lies on what.

use crate::coupling::Coupled;
use crate::exchange::{Node, Outcome};
use crate::placed::Placed;
use crate::report::checks::checks;
use crate::report::inside;

/// More sentences of one kind than this are made one.
const FEW: usize = 4;

/// Matrices of two placements that differ by less than this, relative to their largest number, place at the same place.
const SAME_PLACE: f64 = 1e-6;

/// All sentences.
pub fn notes(placed: &Placed, coupled: &[Coupled], nodes: &[Node], outcome: &Outcome) -> Vec<String> {
    let name = |k: usize| format!("`{}`", placed.instances[k].name);
    let twice = coinciding(placed).into_iter().map(|[a, b]| {
        format!("{} and {} coincide: the same part in the same place; remove one of them", name(a), name(b))
    });
    standing_inside(placed, coupled)
        .into_iter()
        .chain(twice)
        .chain(inside::notes(placed))
        .chain(checks(placed, nodes, outcome))
        .collect()
}

/// What stands inside what: a sentence each, or, of more than a few, how many and the first of them.
fn standing_inside(placed: &Placed, coupled: &[Coupled]) -> Vec<String> {
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

/// Pairs of instances of one part in one place.
fn coinciding(placed: &Placed) -> Vec<[usize; 2]> {
    let numbers = |k: usize| placed.instances[k].placement.to_cols_array();
    let size = |k: usize| numbers(k).iter().fold(0.0f64, |most, n| most.max(n.abs()));
    let coincide = |a: usize, b: usize| {
        let slack = SAME_PLACE * size(a).max(size(b));
        placed.instances[a].part == placed.instances[b].part
            && numbers(a).iter().zip(numbers(b)).all(|(a, b)| (a - b).abs() <= slack)
    };
    let pairs = (0..placed.instances.len()).flat_map(|b| (0..b).map(move |a| [a, b]));
    pairs.filter(|&[a, b]| coincide(a, b)).collect()
}
