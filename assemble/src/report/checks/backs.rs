//! One-sided surfaces whose black backs most of the scene sees: their normals probably point the wrong way.

use super::ray_sample::RaySample;
use crate::placed_parts::PlacedParts;
use equilux_formats::{Element, MaterialId};
use glam::DVec3;
use std::collections::BTreeMap;

/// A surface is reported if at least this share of all sampled rays meets its back,
const MIN_BACK_SHARE: f64 = 0.01;

/// and if its back is seen at least this many times as often as its front. A sheet seen from all around shows both
/// sides equally often.
const MIN_BACK_RATIO: usize = 4;

/// Number of surfaces that are named; the rest are counted.
const MAX_NAMED: usize = 3;

/// The surfaces of one material in an instance: all of them, or those in one plane that face the same way.
type SurfaceGroup = (usize, MaterialId, Option<(u32, bool)>);

/// How often surfaces are seen from each side.
#[derive(Default)]
struct Sightings {
    fronts: usize,
    backs: usize,
    /// The normal of the last surface seen.
    normal: DVec3,
}

/// A note on each of the first few surfaces that show their backs, most seen first.
pub(super) fn notes(placed: &PlacedParts, rays: &RaySample) -> Vec<String> {
    let sightings = sightings(placed, rays);
    let least = MIN_BACK_SHARE * rays.hits.len() as f64;
    let is_wrong =
        |seen: &Sightings| seen.backs as f64 >= least && seen.backs >= MIN_BACK_RATIO * seen.fronts;
    let mut wrong: Vec<(&SurfaceGroup, &Sightings)> = sightings
        .iter()
        .filter(|((instance, material, plane), seen)| {
            // Where a whole mesh is inside out, its planes are not reported separately.
            is_wrong(seen) && (plane.is_none() || !is_wrong(&sightings[&(*instance, *material, None)]))
        })
        .collect();
    wrong.sort_by_key(|(surfaces, seen)| (std::cmp::Reverse(seen.backs), **surfaces));
    let mut notes: Vec<String> =
        wrong.iter().take(MAX_NAMED).map(|(surfaces, seen)| sentence(placed, rays, surfaces, seen)).collect();
    if wrong.len() > MAX_NAMED {
        notes.push(format!("{} more surfaces show their black backs", wrong.len() - MAX_NAMED));
    }
    notes
}

fn sightings(placed: &PlacedParts, rays: &RaySample) -> BTreeMap<SurfaceGroup, Sightings> {
    let mut all: BTreeMap<SurfaceGroup, Sightings> = BTreeMap::new();
    for hit in rays.hits.iter().flatten() {
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

/// The plane of an element, and the side of its face on which it lies.
fn plane(placed: &PlacedParts, element: &Element) -> (u32, bool) {
    let face = &placed.world.faces[element.face.index()];
    (placed.world.plane_of(element.face), face.normal.dot(element.normal) > 0.0)
}

fn sentence(placed: &PlacedParts, rays: &RaySample, surfaces: &SurfaceGroup, seen: &Sightings) -> String {
    let &(instance, material, plane) = surfaces;
    let material = &placed.part_of(instance).part.materials[material.index()].name;
    let what = match plane {
        Some(_) => format!("a wall that faces {} shows its black back", direction(seen.normal)),
        None => "its surfaces show their black backs".to_owned(),
    };
    let percent = |count: usize| 100.0 * count as f64 / rays.hits.len() as f64;
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
