//! Light that never ends: elements that see only each other, absorb nothing, and emit have no equilibrium.

use crate::geometry::disjoint_sets::DisjointSets;
use crate::treecode::MISSED;
use equilux_formats::{ClusterTree, Optics, Rows};

/// Losses below this are rounding of the row sums, not light that gets away.
const NO_LOSS: f64 = 1e-12;

/// The first element of a group that exchanges light only among itself, reflects all of it in some channel and emits
/// in that channel. `rows(i)` lists (sender, form factor) of element i over all elements.
pub fn endless_light(optics: &Optics, rows: impl Fn(usize) -> Vec<(usize, f64)>) -> Option<usize> {
    let n = optics.reflectance.len();
    // Almost every scene absorbs something everywhere: then there is nothing to look for.
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

/// The same for one block.
pub fn endless_in_block(optics: &Optics, block: &Rows, clusters: &ClusterTree) -> Option<usize> {
    endless_light(optics, |i| {
        // What a row may lack counts as staying: clusters must not open a closed part.
        let rounding = block.rounding();
        let mut row = if rounding > 0.0 { vec![(i, rounding + MISSED)] } else { vec![] };
        for (node, value) in block.row(i) {
            clusters.spread(node, &mut |element, share| row.push((element, value * share)));
        }
        row
    })
}
