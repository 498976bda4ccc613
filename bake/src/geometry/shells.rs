//! Finds closed shells among polygons: groups that enclose a volume, and which of their polygons face into it.
//!
//! A shell is closed if each edge lies between two polygons. If the winding of its polygons is inconsistent but does
//! not matter, one winding is propagated across the edges. How often a shell goes around a point is the sum of the
//! solid angles of its polygons over 4π: 1 inside, 0 outside, whatever its shape (Jacobson, Kavan & Sorkine-Hornung
//! 2013).

use crate::geometry::disjoint_sets::DisjointSets;
use crate::geometry::point_key::{EdgeKey, edge_keys};
use crate::geometry::polygon::Polygon;
use crate::geometry::solid_angle::solid_angle;
use crate::geometry::tolerance::NO_VOLUME;
use glam::DVec3;
use std::collections::HashMap;
use std::f64::consts::PI;

/// Polygons that enclose a volume.
#[derive(Debug, Clone, PartialEq)]
pub struct Shell {
    /// The numbers of its polygons, rising.
    pub polygons: Vec<u32>,
    /// For each of them, whether its front faces into the shell.
    pub inward: Vec<bool>,
}

/// The closed shells among `polygons`. `either_way(i)` returns whether the winding of polygon `i` may be reversed,
/// because its sides are alike.
pub fn closed_shells(polygons: &[&[DVec3]], either_way: impl Fn(usize) -> bool) -> Vec<Shell> {
    let groups = groups_by_edges(polygons);
    groups.iter().filter_map(|group| shell(group, polygons, &either_way)).collect()
}

/// Groups of polygons connected by whole edges, ordered by their first polygon.
pub(crate) fn groups_by_edges(polygons: &[&[DVec3]]) -> Vec<Vec<usize>> {
    let mut sets = DisjointSets::new(polygons.len());
    let mut first_at: HashMap<EdgeKey, usize> = HashMap::new();
    for (number, corners) in polygons.iter().enumerate() {
        for (edge, _) in edge_keys(corners) {
            let other = *first_at.entry(edge).or_insert(number);
            sets.join(number, other);
        }
    }
    sets.into_sets()
}

fn shell(group: &[usize], polygons: &[&[DVec3]], either_way: impl Fn(usize) -> bool) -> Option<Shell> {
    let turned = if is_balanced(group, polygons) {
        vec![false; group.len()]
    } else if group.iter().all(|&polygon| either_way(polygon)) {
        one_winding(group, polygons)?
    } else {
        return None;
    };
    let wound = group.iter().zip(&turned).map(|(&polygon, &turned)| (polygons[polygon], turned));
    let (volume, area) = volume_and_area(wound);
    if volume.abs() <= NO_VOLUME * area.powf(1.5) {
        return None;
    }
    let inward = turned.iter().map(|&turned| turned != (volume < 0.0)).collect();
    Some(Shell { polygons: group.iter().map(|&polygon| polygon as u32).collect(), inward })
}

/// Whether each edge occurs equally often in both directions.
pub(crate) fn is_balanced(group: &[usize], polygons: &[&[DVec3]]) -> bool {
    let mut balance: HashMap<EdgeKey, i32> = HashMap::new();
    for (edge, forth) in group.iter().flat_map(|&polygon| edge_keys(polygons[polygon])) {
        *balance.entry(edge).or_default() += if forth { 1 } else { -1 };
    }
    balance.values().all(|&balance| balance == 0)
}

/// Which polygons of a group must be reversed so that each edge occurs in both directions; none if an edge does not lie
/// between two polygons, or if the surface is not orientable.
fn one_winding(group: &[usize], polygons: &[&[DVec3]]) -> Option<Vec<bool>> {
    let mut at: HashMap<EdgeKey, Vec<(usize, bool)>> = HashMap::new();
    for (place, &polygon) in group.iter().enumerate() {
        for (edge, forth) in edge_keys(polygons[polygon]) {
            at.entry(edge).or_default().push((place, forth));
        }
    }
    if at.values().any(|sides| sides.len() != 2) {
        return None;
    }
    let mut turned: Vec<Option<bool>> = vec![None; group.len()];
    turned[0] = Some(false);
    let mut open = vec![0];
    while let Some(place) = open.pop() {
        for (edge, forth) in edge_keys(polygons[group[place]]) {
            let sides = &at[&edge];
            let &(other, other_forth) = if sides[0] == (place, forth) { &sides[1] } else { &sides[0] };
            let wanted = turned[place].expect("only turned polygons are open") != (forth == other_forth);
            match turned[other] {
                None => {
                    turned[other] = Some(wanted);
                    open.push(other);
                }
                Some(known) if known != wanted => return None,
                Some(_) => {}
            }
        }
    }
    turned.into_iter().collect()
}

/// The volume inside a closed surface, negative if its polygons face inwards, and its area.
pub(crate) fn volume_and_area<'a>(polygons: impl Iterator<Item = (&'a [DVec3], bool)>) -> (f64, f64) {
    let (mut origin, mut volume, mut area) = (None, 0.0, 0.0);
    for (corners, turned) in polygons {
        let origin = *origin.get_or_insert(corners[0]);
        let sign = if turned { -1.0 } else { 1.0 };
        for [a, b, c] in triangles(corners) {
            let normal = (b - a).cross(c - a);
            volume += sign * normal.dot(a - origin) / 6.0;
            area += normal.length() / 2.0;
        }
    }
    (volume, area)
}

/// The winding number of outward-facing polygons around a point: 1 inside a closed shell, 0 outside, between on it.
pub fn winding_number<'a>(point: DVec3, polygons: impl Iterator<Item = &'a [DVec3]>) -> f64 {
    let seen = |corners: &[DVec3]| {
        let corners: Polygon = corners.iter().map(|&corner| corner - point).collect();
        solid_angle(&corners)
    };
    polygons.map(seen).sum::<f64>() / (4.0 * PI)
}

/// The triangle fan of a convex polygon around its first corner.
pub(crate) fn triangles(corners: &[DVec3]) -> impl Iterator<Item = [DVec3; 3]> + '_ {
    corners.windows(2).skip(1).map(|edge| [corners[0], edge[0], edge[1]])
}
