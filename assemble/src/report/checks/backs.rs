//! One-sided surfaces that show most of the scene their black backs: their normals probably point the wrong way.

use super::view::View;
use crate::placed::Placed;
use equilux_formats::{Element, MaterialId};
use glam::DVec3;
use std::collections::BTreeMap;

/// A side is named if at least this share of what the scene sees is its back.
const SHARE: f64 = 0.01;

/// And if its back is seen this many times as often as its front. Seen from all around, a sheet shows as much of either.
const OFTENER: usize = 4;

/// Normals within such a cube look the same way.
const DIRECTIONS: f64 = 16.0;

/// So many sides are named.
const NAMED: usize = 3;

/// Faces of one instance that are of one material and look the same way.
type Side = (usize, MaterialId, [i32; 3]);

/// How often a side is seen.
#[derive(Default)]
struct Seen {
    fronts: usize,
    backs: usize,
    /// Where it looks.
    normal: DVec3,
}

/// A sentence for each of the first few sides that show their backs, most seen first.
pub(super) fn notes(placed: &Placed, view: &View) -> Vec<String> {
    let mut sides: BTreeMap<Side, Seen> = BTreeMap::new();
    for hit in view.hits.iter().flatten() {
        let element = &placed.world.elements[hit.element];
        let instance = placed.world.instance_of_node(placed.world.node_of(hit.element));
        let seen = sides.entry(side(instance, element)).or_default();
        seen.normal = element.normal;
        *(if hit.front { &mut seen.fronts } else { &mut seen.backs }) += 1;
    }
    let least = SHARE * view.hits.len() as f64;
    let mut wrong: Vec<(Side, Seen)> = sides
        .into_iter()
        .filter(|(_, seen)| seen.backs as f64 >= least && seen.backs >= OFTENER * seen.fronts)
        .collect();
    wrong.sort_by_key(|(side, seen)| (std::cmp::Reverse(seen.backs), *side));
    let note = |((instance, material, _), seen): &(Side, Seen)| {
        let part = &placed.part_of(*instance).part;
        let material = &part.materials[material.index()].name;
        let of = if material.is_empty() { String::new() } else { format!(" (material `{material}`)") };
        format!(
            "`{}`{of}: faces that look along {} show their black backs to {:.0} % of the scene and their fronts to {:.0} %; \
             flip their normals, or make the material double-sided",
            placed.instances[*instance].name,
            direction(seen.normal),
            percent(seen.backs, view),
            percent(seen.fronts, view)
        )
    };
    let mut notes: Vec<String> = wrong.iter().take(NAMED).map(note).collect();
    if wrong.len() > NAMED {
        notes.push(format!("{} more sides show their black backs", wrong.len() - NAMED));
    }
    notes
}

fn side(instance: usize, element: &Element) -> Side {
    (instance, element.material, (element.normal * DIRECTIONS).round().as_ivec3().to_array())
}

fn percent(count: usize, view: &View) -> f64 {
    100.0 * count as f64 / view.hits.len() as f64
}

fn direction(normal: DVec3) -> String {
    let [x, y, z] = normal.to_array().map(|x| (100.0 * x).round() / 100.0 + 0.0);
    format!("({x}, {y}, {z})")
}
