//! Rows that sum to more than one: light is counted twice. Either faces of the scene overlap, or a form factor is
//! wrong; the note says which.

use super::ray_sample::RaySample;
use crate::exchange::system::InstanceSystem;
use crate::placed_parts::PlacedParts;
use crate::statistics::row_sums;
use equilux_bake::rays::Hit;

/// Maximum excess of a row sum over one due to rounding of its entries.
const MAX_ROUNDING_EXCESS: f64 = 1e-6;

/// Two senders overlap if a ray meets them within this share of the distance.
const OVERLAP_SHARE: f64 = 1e-5;

/// Number of instances that are named; the rest are counted.
const MAX_NAMED: usize = 3;

/// A note on the worst row of each of the first few instances with a row sum above one.
pub(super) fn notes(placed: &PlacedParts, systems: &[InstanceSystem], rays: &RaySample) -> Vec<String> {
    let worst = |system: &InstanceSystem| row_sums(system).enumerate().max_by(|a, b| a.1.total_cmp(&b.1));
    let rows =
        systems.iter().enumerate().filter_map(|(k, system)| worst(system).map(|(row, sum)| (k, row, sum)));
    let overfull: Vec<(usize, usize, f64)> =
        rows.filter(|&(_, _, sum)| sum > 1.0 + MAX_ROUNDING_EXCESS).collect();
    let name = |k: usize| format!("`{}`", placed.instances[k].name);
    let note = |&(k, row, sum): &(usize, usize, f64)| {
        let receiver = placed.world.elements_of(k).start + row;
        let sees =
            format!("element {receiver} of {} sees {:.4} % of the possible maximum", name(k), 100.0 * sum);
        match overlapping_senders(placed, systems, rays, (k, row)) {
            Some([a, b]) => format!(
                "{sees}: faces of {} and {} overlap, and the light of both is counted; move them apart",
                name(a),
                name(b)
            ),
            None => format!(
                "{sees}, although no two faces overlap: its form factors are wrong; please report this file as a bug of \
                 Equilux"
            ),
        }
    };
    let mut notes: Vec<String> = overfull.iter().take(MAX_NAMED).map(note).collect();
    if overfull.len() > MAX_NAMED {
        notes.push(format!("rows of {} more parts sum to more than 1", overfull.len() - MAX_NAMED));
    }
    notes
}

/// The instances of two senders of a row that overlap, if there are any.
fn overlapping_senders(
    placed: &PlacedParts,
    systems: &[InstanceSystem],
    rays: &RaySample,
    (k, row): (usize, usize),
) -> Option<[usize; 2]> {
    let world = &placed.world;
    let origin = world.elements[world.elements_of(k).start + row].centroid;
    let own = systems[k].self_block.row(row).map(|(column, _)| column + world.nodes_of(k).start);
    let senders = own.chain(systems[k].coupling.row(row).map(|(column, _)| column));
    let instance_of = |element: usize| world.instance_of_node(world.node_of(element));
    senders.flat_map(|node| elements_in(placed, node)).find_map(|sender| {
        let direction = world.elements[sender].centroid - origin;
        let is_there = |hit: &Hit| (hit.distance - 1.0).abs() <= OVERLAP_SHARE;
        let others = rays.index.all_hits(origin, direction).into_iter().filter(is_there);
        let mut others = others
            .filter(|hit| hit.front && hit.element != sender && !share_an_edge(placed, hit.element, sender));
        others.next().map(|other| [instance_of(sender), instance_of(other.element)])
    })
}

/// Whether two elements belong to the same face, so that they lie side by side.
fn share_an_edge(placed: &PlacedParts, a: usize, b: usize) -> bool {
    placed.world.elements[a].face == placed.world.elements[b].face
}

/// The elements of a node of the scene.
fn elements_in(placed: &PlacedParts, node: usize) -> Vec<usize> {
    let (mut open, mut elements) = (vec![node as u32], Vec::new());
    while let Some(node) = open.pop() {
        match placed.world.nodes[node as usize].children {
            Some(children) => open.extend(children),
            None => elements.extend(placed.world.element_of(node as usize)),
        }
    }
    elements
}
