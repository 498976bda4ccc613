//! Finds the closed solids of a part among its faces, and tests which points lie inside them. All in the part's coordinates.
//!
//! A solid is a closed shell of faces with elements on the outside only. Rooms, open shells, and faces with elements on
//! both sides are not solids.

use crate::geometry::aabb::Aabb;
use crate::geometry::box_tree::BoxTree;
use crate::geometry::crossings::crossings;
use crate::geometry::disjoint_sets::DisjointSets;
use crate::geometry::point_key::point_key;
use crate::geometry::polygon::distance;
use crate::geometry::shells::{
    closed_shells, groups_by_edges, is_balanced, triangles, volume_and_area, winding_number,
};
use crate::geometry::tolerance::{CLOSED, WOUND};
use equilux_formats::{Element, Face, Geometry};
use glam::DVec3;
use std::collections::HashMap;
use std::sync::OnceLock;

/// A closed shell of outward-facing faces.
#[derive(Debug)]
pub struct Solid {
    /// The box around it.
    pub bounds: Aabb,
    /// Its faces, sorted.
    pub faces: Vec<u32>,
    /// Whether its faces share whole edges, so that the faces on a ray tell whether a point lies inside.
    has_whole_edges: bool,
    /// The boxes of its faces.
    tree: OnceLock<BoxTree>,
}

/// The solids of a part.
pub fn solids(geometry: &Geometry) -> Vec<Solid> {
    let faces = &geometry.faces;
    let lit_behind = lit_behind(&geometry.elements, faces);
    let is_dark_inside = |solid: &Solid| !solid.faces.iter().any(|&f| lit_behind[f as usize]);
    shells(faces).into_iter().filter(is_dark_inside).collect()
}

impl Solid {
    fn of(shell: Vec<u32>, has_whole_edges: bool, faces: &[Face]) -> Self {
        let bounds = Aabb::around(shell.iter().flat_map(|&f| &faces[f as usize].corners));
        Self { bounds, faces: shell, has_whole_edges, tree: OnceLock::new() }
    }

    /// Whether `point` lies inside, deeper than `depth` below every face. `faces` are those of the solid's part.
    pub fn holds(&self, point: DVec3, depth: f64, faces: &[Face]) -> bool {
        let in_box =
            (point - depth).cmpgt(self.bounds.low).all() && (point + depth).cmplt(self.bounds.high).all();
        in_box && !self.is_near(point, depth, faces) && self.goes_around(point, faces)
    }

    /// Whether a face is no farther from `point` than `depth`.
    fn is_near(&self, point: DVec3, depth: f64, faces: &[Face]) -> bool {
        let around = Aabb { low: point, high: point }.grown(depth);
        self.meeting(around, faces).any(|corners| distance(point, corners) <= depth)
    }

    /// Whether it goes around a point that is not on it.
    fn goes_around(&self, point: DVec3, faces: &[Face]) -> bool {
        if self.has_whole_edges {
            let ray = Aabb { low: point, high: point.with_x(self.bounds.high.x) };
            return crossings(point, self.meeting(ray, faces)) > 0;
        }
        let own = self.faces.iter().map(|&face| faces[face as usize].corners.as_slice());
        winding_number(point, own) > 1.0 - WOUND
    }

    /// The corners of its faces whose boxes may meet `sought`.
    fn meeting<'a>(&self, sought: Aabb, faces: &'a [Face]) -> impl Iterator<Item = &'a [DVec3]> {
        let corners = |place: u32| faces[self.faces[place as usize] as usize].corners.as_slice();
        let boxes =
            || (0..self.faces.len() as u32).map(|place| Aabb::around(corners(place))).collect::<Vec<_>>();
        let tree = self.tree.get_or_init(|| BoxTree::new(&boxes()));
        tree.meeting(sought).into_iter().map(corners)
    }
}

/// Which faces have elements on their backs.
pub(crate) fn lit_behind(elements: &[Element], faces: &[Face]) -> Vec<bool> {
    let mut lit = vec![false; faces.len()];
    for element in elements {
        let face = element.face.index();
        lit[face] |= element.normal.dot(faces[face].normal) < 0.0;
    }
    lit
}

/// Outward-facing shells: faces closed by whole edges, and of the others those that are closed and share corners, such
/// as the merged faces of a wall with a door.
fn shells(faces: &[Face]) -> Vec<Solid> {
    let polygons: Vec<&[DVec3]> = faces.iter().map(|face| face.corners.as_slice()).collect();
    let by_edges = closed_shells(&polygons, |_| false);
    let outwards = by_edges.into_iter().filter(|shell| !shell.inward[0]);
    let outwards = outwards.map(|shell| Solid::of(shell.polygons, true, faces));
    let groups = groups_by_edges(&polygons).into_iter();
    let mut rest: Vec<usize> = groups.filter(|group| !is_balanced(group, &polygons)).flatten().collect();
    rest.sort_unstable();
    let by_corners = groups_by_corners(&rest, &polygons).into_iter();
    let by_corners = by_corners.filter(|group| is_closed_outwards(group, &polygons));
    outwards.chain(by_corners.map(|group| Solid::of(numbers(group), false, faces))).collect()
}

fn numbers(group: Vec<usize>) -> Vec<u32> {
    group.into_iter().map(|face| face as u32).collect()
}

/// Those of `polygons` named in `which`, in groups that share corners.
fn groups_by_corners(which: &[usize], polygons: &[&[DVec3]]) -> Vec<Vec<usize>> {
    let mut sets = DisjointSets::new(which.len());
    let mut first_at = HashMap::new();
    for (place, &polygon) in which.iter().enumerate() {
        for &corner in polygons[polygon] {
            let other = *first_at.entry(point_key(corner)).or_insert(place);
            sets.join(place, other);
        }
    }
    sets.into_sets().into_iter().map(|set| set.into_iter().map(|place| which[place]).collect()).collect()
}

fn is_closed_outwards(group: &[usize], polygons: &[&[DVec3]]) -> bool {
    let own = || group.iter().map(|&polygon| polygons[polygon]);
    let double_area = |corners| triangles(corners).map(|[a, b, c]| (b - a).cross(c - a)).sum::<DVec3>();
    let (volume, area) = volume_and_area(own().map(|corners| (corners, false)));
    own().map(double_area).sum::<DVec3>().length() <= CLOSED * 2.0 * area && volume > 0.0
}
