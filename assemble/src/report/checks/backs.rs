//! One-sided surfaces that show most of the scene their black backs: their normals probably point the wrong way.

use super::view::View;
use crate::placed_parts::PlacedParts;
use equilux_formats::{Element, MaterialId};
use glam::DVec3;
use std::collections::BTreeMap;

/// A surface is named if at least this share of what the scene sees is its back.
const SHARE: f64 = 0.01;

/// And if its back is seen this many times as often as its front. Seen from all around, a sheet shows as much of either.
const OFTENER: usize = 4;

/// So many surfaces are named.
const NAMED: usize = 3;

/// The surfaces of one material in an instance: all of them, or those in one plane that look the same way.
type Surfaces = (usize, MaterialId, Option<(u32, bool)>);

/// How often surfaces are seen.
#[derive(Default)]
struct Sightings {
    fronts: usize,
    backs: usize,
    /// Where the last of them looks.
    normal: DVec3,
}

/// A sentence for each of the first few surfaces that show their backs, most seen first.
pub(super) fn notes(placed: &PlacedParts, view: &View) -> Vec<String> {
    let sightings = sightings(placed, view);
    let least = SHARE * view.hits.len() as f64;
    let is_wrong = |seen: &Sightings| seen.backs as f64 >= least && seen.backs >= OFTENER * seen.fronts;
    let mut wrong: Vec<(&Surfaces, &Sightings)> = sightings
        .iter()
        .filter(|((instance, material, plane), seen)| {
            // Where a whole mesh is inside out, its planes are not named one by one.
            is_wrong(seen) && (plane.is_none() || !is_wrong(&sightings[&(*instance, *material, None)]))
        })
        .collect();
    wrong.sort_by_key(|(surfaces, seen)| (std::cmp::Reverse(seen.backs), **surfaces));
    let mut notes: Vec<String> =
        wrong.iter().take(NAMED).map(|(surfaces, seen)| sentence(placed, view, surfaces, seen)).collect();
    if wrong.len() > NAMED {
        notes.push(format!("{} more surfaces show their black backs", wrong.len() - NAMED));
    }
    notes
}

fn sightings(placed: &PlacedParts, view: &View) -> BTreeMap<Surfaces, Sightings> {
    let mut all: BTreeMap<Surfaces, Sightings> = BTreeMap::new();
    for hit in view.hits.iter().flatten() {
        let element = &placed.world.elements[hit.element];
        let instance = placed.world.instance_of_node(placed.world.node_of(hit.element));
        for plane in [None, Some(plane(placed, element))] {
            let seen = all.entry((instance, element.material, plane)).or_default();
            seen.normal = element.normal;
            *(if hit.front { &mut seen.fronts } else { &mut seen.backs }) += 1;
        }
    }
    all
}

/// The plane of an element, and the side of its face that it is on.
fn plane(placed: &PlacedParts, element: &Element) -> (u32, bool) {
    let face = &placed.world.faces[element.face.index()];
    (placed.world.plane_of(element.face), face.normal.dot(element.normal) > 0.0)
}

fn sentence(placed: &PlacedParts, view: &View, surfaces: &Surfaces, seen: &Sightings) -> String {
    let &(instance, material, plane) = surfaces;
    let material = &placed.part_of(instance).part.materials[material.index()].name;
    let what = match plane {
        Some(_) => format!("a wall that looks along {} shows its black back", direction(seen.normal)),
        None => "its surfaces show their black backs".to_owned(),
    };
    let percent = |count: usize| 100.0 * count as f64 / view.hits.len() as f64;
    format!(
        "`{}`, material `{material}`: {what} to {:.0} % of the scene, the front to {:.0} %; flip the normals, or make the \
         material double-sided",
        placed.instances[instance].name,
        percent(seen.backs),
        percent(seen.fronts)
    )
}

fn direction(normal: DVec3) -> String {
    let [x, y, z] = normal.to_array().map(|x| (100.0 * x).round() / 100.0 + 0.0);
    format!("({x}, {y}, {z})")
}
