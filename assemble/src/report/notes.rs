//! Sentences on what a person should know of the parts in their places: what stands in what, and what lies on what.

use crate::coupling::Coupled;
use crate::exchange::Node;
use crate::placed::Placed;
use crate::report::inside;

/// A row that sums to more than this counts light twice. Rows end within 1e-5 of 1, and steps round less.
const TOO_MUCH: f64 = 1.0 + 1e-4;

/// Matrices of two placements that differ by less than this, relative to their largest number, place at the same place.
const SAME_PLACE: f64 = 1e-6;

/// All sentences.
pub fn notes(placed: &Placed, coupled: &[Coupled], nodes: &[Node]) -> Vec<String> {
    let name = |k: usize| format!("`{}`", placed.instances[k].name);
    let inside = coupled.iter().enumerate().filter_map(|(k, own)| {
        let corrected = own.corrected.as_ref()?;
        let inside: Vec<String> = corrected.intruders.iter().map(|&i| name(i)).collect();
        let how =
            if corrected.origin.is_reused() { "taken corrected from the cache" } else { "computed anew" };
        Some(format!("inside {} is {}: its own block was {how}", name(k), inside.join(", ")))
    });
    let twice = coinciding(placed).into_iter().map(|[a, b]| {
        format!("{} and {} coincide: the same part in the same place; remove one of them", name(a), name(b))
    });
    let overlapping = nodes.iter().enumerate().filter_map(|(k, node)| {
        let sums = (0..node.areas.len()).map(|i| node.self_block.row_sum(i) + node.coupling.row_sum(i));
        let most = sums.fold(0.0, f64::max);
        (most > TOO_MUCH).then(|| {
            format!(
                "{} sees {:.1} % of what there can be: faces overlap in one plane, and the light of both is counted; \
                 move one of them off the other",
                name(k),
                100.0 * most
            )
        })
    });
    inside.chain(twice).chain(overlapping).chain(inside::notes(placed)).collect()
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
