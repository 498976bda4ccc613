//! Detects parts without an equilibrium: elements that see only each other, reflect all light, and emit.

use crate::geometry::disjoint_sets::DisjointSets;
use crate::treecode::MISSED;
use equilux_formats::{ClusterTree, Optics, Rows};

/// Smaller losses are rounding of the row sums, not absorbed or escaping light.
const NO_LOSS: f64 = 1e-12;

/// An emitting element of a group of elements that see only each other and whose reflectance is 1 in the channel of the
/// emission; none if there is no such group. `rows(i)` lists (sender, form factor) of element i over all elements.
pub fn endless_light(optics: &Optics, rows: impl Fn(usize) -> Vec<(usize, f64)>) -> Option<usize> {
    let n = optics.reflectance.len();
    // In almost every scene all elements absorb light, and the search can be skipped.
    if optics.reflectance.iter().all(|rho| rho.iter().all(|&r| r < 1.0 - NO_LOSS)) {
        return None;
    }
    let mut groups = DisjointSets::new(n);
    let mut sums = vec![0.0; n];
    for (i, sum) in sums.iter_mut().enumerate() {
        for (j, value) in rows(i) {
            *sum += value;
            groups.join(i, j);
        }
    }
    for channel in 0..3 {
        let mut loses = vec![false; n];
        let mut emitter = vec![None; n];
        for (i, sum) in sums.iter().enumerate() {
            let root = groups.root(i);
            loses[root] |= 1.0 - optics.reflectance[i][channel] * sum > NO_LOSS;
            if optics.emission[i][channel] > 0.0 {
                emitter[root] = emitter[root].or(Some(i));
            }
        }
        if let Some(found) = (0..n).filter(|&root| !loses[root]).find_map(|root| emitter[root]) {
            return Some(found);
        }
    }
    None
}

/// [`endless_light`] for one block.
pub fn endless_in_block(optics: &Optics, block: &Rows, clusters: &ClusterTree) -> Option<usize> {
    endless_light(optics, |i| {
        // The error of a row counts as light that stays: clusters must not open a closed part.
        let rounding = block.rounding();
        let mut row = if rounding > 0.0 { vec![(i, rounding + MISSED)] } else { vec![] };
        for (node, value) in block.row(i) {
            clusters.spread(node, &mut |element, share| row.push((element, value * share)));
        }
        row
    })
}
