//! Removes overlaps of coplanar surfaces that face the same way: one of them stays, and what it covers of the others is cut away.
//! Otherwise every row that sees one would count both.
//!
//! Overlaps within a part are cut for all of its instances, and the first surface stays. Of instances, the larger keeps its
//! surfaces, so that a room remains the part that it is elsewhere whatever stands in it; of equal ones, the first. An instance
//! that another instance covers gets a new part, shared by all instances that are covered in the same way.

use super::bounds::{part_bounds, placed_bounds};
use super::cells::{Facing, seen_pieces};
use crate::geometry::aabb::Aabb;
use crate::geometry::box_tree::BoxTree;
use crate::geometry::planes;
use crate::geometry::rounded_placement::RoundedPlacement;
use crate::geometry::shells::closed_shells;
use equilux_formats::{Instance, Part, PartId, Scene, Surface};
use glam::{DAffine3, DVec3};
use std::collections::BTreeMap;

/// The number of parts and pairs of parts that a note names; the rest are counted.
const NAMED: usize = 3;

/// Cuts away covered surfaces, and adds a note.
pub(super) fn cut_overlaps(scene: &mut Scene) {
    let mut covered = Vec::new();
    for part in &mut scene.parts {
        let count = cut_within(part);
        if count > 0 {
            covered.push(format!("{count} of `{}` on others of it", part.name));
        }
    }
    covered.extend(cut_across(scene));
    if covered.is_empty() {
        return;
    }
    let more = match covered.len().saturating_sub(NAMED) {
        0 => String::new(),
        more => format!(", and {more} more such pairs"),
    };
    covered.truncate(NAMED);
    scene.notes.push(format!(
        "faces lie on others in one plane and look the same way: {}{more}; one face of each place was kept, that of the larger \
         part, and what it covers of the others was cut away",
        covered.join(", ")
    ));
}

/// Sides of surfaces with a spatial index.
struct Sides {
    /// The surface of each side, and the side.
    all: Vec<(usize, Facing)>,
    tree: BoxTree,
}

impl Sides {
    /// The sides of the surfaces of a part after `placement`, where `is_wanted` takes their boxes.
    fn of(part: &Part, placement: DAffine3, is_wanted: impl Fn(&Aabb) -> bool) -> Self {
        let placed = part.surfaces.iter().map(|surface| surface.placed(placement)).enumerate();
        let sides = placed.flat_map(|(number, surface)| {
            let sides: Vec<Facing> = Facing::sides(part, &surface).collect();
            sides.into_iter().map(move |side| (number, side))
        });
        let all: Vec<(usize, Facing)> = sides.filter(|(_, side)| is_wanted(&side.bounds())).collect();
        let boxes: Vec<Aabb> = all.iter().map(|(_, side)| side.bounds()).collect();
        Self { tree: BoxTree::new(&boxes), all }
    }

    /// The numbers of those that overlap `side`, in rising order, of surfaces for which `counts` returns true.
    fn on(&self, side: &Facing, tolerance: f64, counts: impl Fn(usize) -> bool) -> Vec<usize> {
        let near = self.tree.meeting(side.bounds().grown(tolerance)).into_iter().map(|i| i as usize);
        let mut on: Vec<usize> =
            near.filter(|&i| counts(self.all[i].0) && self.all[i].1.overlaps(side, tolerance)).collect();
        on.sort_unstable();
        on
    }
}

/// Cuts away what earlier surfaces of the part cover, and returns the number of surfaces that are worth a note.
fn cut_within(part: &mut Part) -> usize {
    let corners = || part.surfaces.iter().flat_map(|surface| surface.corners.as_slice());
    let tolerance = planes::tolerance(corners());
    let sides = Sides::of(part, DAffine3::IDENTITY, |_| true);
    let mut covers: BTreeMap<usize, Vec<Facing>> = BTreeMap::new();
    for (surface, side) in &sides.all {
        for on in sides.on(side, tolerance, |other| other < *surface) {
            covers.entry(*surface).or_default().push(sides.all[on].1.clone());
        }
    }
    let count = noticed(part, &covers);
    part.surfaces = cut(part, &covers, tolerance);
    count
}

/// The number of covered surfaces that are worth a note. A solid against a two-sided sheet, such as a crate on a floor,
/// has a face in the plane of the sheet's other side; that face is never seen.
fn noticed(part: &Part, covers: &BTreeMap<usize, Vec<Facing>>) -> usize {
    if covers.is_empty() {
        return 0;
    }
    let polygons: Vec<&[DVec3]> = part.surfaces.iter().map(|s| s.corners.as_slice()).collect();
    let mut is_of_solid = vec![false; polygons.len()];
    for shell in closed_shells(&polygons, |_| false) {
        for (&surface, &inward) in shell.polygons.iter().zip(&shell.inward) {
            let surface = surface as usize;
            is_of_solid[surface] = !inward && !part.is_two_sided(&part.surfaces[surface]);
        }
    }
    let is_noticed =
        |surface: usize, on: &[Facing]| !is_of_solid[surface] || on.iter().any(|cover| !cover.two_sided);
    covers.iter().filter(|(surface, on)| is_noticed(**surface, on)).count()
}

/// The visible surfaces of a part under `covers`.
fn cut(part: &Part, covers: &BTreeMap<usize, Vec<Facing>>, tolerance: f64) -> Vec<Surface> {
    let pieces = |(number, surface): (usize, &Surface)| match covers.get(&number) {
        Some(covers) => seen_pieces(part, surface, covers, tolerance),
        None => vec![*surface],
    };
    part.surfaces.iter().enumerate().flat_map(pieces).collect()
}

/// Cuts away what larger instances cover, and returns phrases for the note.
fn cut_across(scene: &mut Scene) -> Vec<String> {
    let bounds: Vec<Aabb> = scene.instances.iter().map(|i| placed_bounds(&scene.parts, i)).collect();
    let tolerances: Vec<f64> = bounds.iter().map(|b| planes::tolerance([&b.low, &b.high])).collect();
    let tree = BoxTree::new(&bounds);
    let (mut variants, mut covered) = (Variants::default(), Vec::new());
    let mut order: Vec<usize> = (0..bounds.len()).collect();
    order.sort_by(|&a, &b| bounds[b].diagonal().total_cmp(&bounds[a].diagonal()));
    let mut rank = vec![0; order.len()];
    order.iter().enumerate().for_each(|(place, &number)| rank[number] = place);
    for number in order {
        let widest = tolerances.iter().copied().fold(0.0, f64::max);
        let near = tree.meeting(bounds[number].grown(widest)).into_iter().map(|other| other as usize);
        let tolerance = |other: usize| tolerances[number].max(tolerances[other]);
        let is_near = |&other: &usize| {
            rank[other] < rank[number] && meet(&bounds[other], &bounds[number], tolerance(other))
        };
        let mut near: Vec<usize> = near.filter(is_near).collect();
        near.sort_unstable_by_key(|&other| rank[other]);
        let mut covers: BTreeMap<usize, Vec<Facing>> = BTreeMap::new();
        for other in near {
            let found = covered_by(scene, number, other, tolerance(other));
            let part = &scene.parts[scene.instances[number].part.index()];
            let count = noticed(part, &found);
            if count > 0 {
                let [own, other] = [number, other].map(|k| &scene.instances[k].name);
                let count = if count == part.surfaces.len() { "all".to_owned() } else { count.to_string() };
                covered.push(format!("{count} of `{own}` on `{other}`"));
            }
            found.into_iter().for_each(|(surface, cover)| covers.entry(surface).or_default().extend(cover));
        }
        if !covers.is_empty() {
            let scale = scale(&scene.instances[number]);
            let part = scene.instances[number].part;
            let surfaces = cut(&scene.parts[part.index()], &covers, tolerances[number] / scale);
            scene.instances[number].part = variants.part(&mut scene.parts, part, surfaces);
        }
    }
    covered
}

fn meet(a: &Aabb, b: &Aabb, tolerance: f64) -> bool {
    (a.low - tolerance).cmple(b.high).all() && (b.low - tolerance).cmple(a.high).all()
}

/// For each surface of instance `own`, the sides of instance `other` that lie on it, in the coordinates of `own`.
fn covered_by(scene: &Scene, own: usize, other: usize, tolerance: f64) -> BTreeMap<usize, Vec<Facing>> {
    let [(own, part), (other, other_part)] =
        [own, other].map(|k| (&scene.instances[k], &scene.parts[scene.instances[k].part.index()]));
    let tolerance = tolerance / scale(own);
    let to_own = DAffine3::from(RoundedPlacement::from(own.placement.inverse() * other.placement));
    let own_bounds = part_bounds(part);
    let is_near = |other: &Aabb| meet(other, &own_bounds, tolerance);
    let sides = Sides::of(other_part, to_own, is_near);
    let mut covers: BTreeMap<usize, Vec<Facing>> = BTreeMap::new();
    if sides.all.is_empty() {
        return covers;
    }
    for (number, surface) in part.surfaces.iter().enumerate() {
        for side in Facing::sides(part, surface) {
            let on = sides.on(&side, tolerance, |_| true);
            if !on.is_empty() {
                covers.entry(number).or_default().extend(on.into_iter().map(|i| sides.all[i].1.clone()));
            }
        }
    }
    covers
}

fn scale(instance: &Instance) -> f64 {
    instance.placement.matrix3.determinant().abs().cbrt()
}

/// Parts that were derived from others by cutting.
#[derive(Default)]
struct Variants {
    /// By the original part.
    of: BTreeMap<u32, Vec<PartId>>,
}

impl Variants {
    /// `part` with these surfaces instead of its own.
    fn part(&mut self, parts: &mut Vec<Part>, part: PartId, surfaces: Vec<Surface>) -> PartId {
        let known = self.of.entry(part.0).or_default();
        if let Some(&same) = known.iter().find(|id| parts[id.index()].surfaces == surfaces) {
            return same;
        }
        let name = format!("{} (cut {})", parts[part.index()].name, known.len() + 1);
        let id = PartId::from_index(parts.len());
        known.push(id);
        parts.push(Part { name, surfaces, ..parts[part.index()].clone() });
        id
    }
}
