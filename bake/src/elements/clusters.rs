//! Builds the hierarchy of a part's elements. The elements of each face side are halved along the longer side of the
//! face until single elements are left, at grid lines where there are any, so that clusters of a grid are rectangles.
//! The face sides themselves are halved by position.

use crate::geometry::aabb::Aabb;
use crate::geometry::tolerance::SAME_LINE;
use crate::rays::RayIndex;
use equilux_formats::{ClusterTree, Element, Face, Geometry};
use glam::DVec3;
use std::collections::HashMap;

/// An element counts as covered if an obstacle in front of it is nearer than this share of its face's extent. Covered
/// elements share clusters only with covered elements.
const COVERED_WITHIN: f64 = 0.1;

/// The geometry of these elements and faces; elements are sorted into the order of their hierarchy.
pub fn geometry(elements: Vec<Element>, faces: Vec<Face>) -> Geometry {
    let (order, clusters) = hierarchy(&elements);
    Geometry { elements: order.iter().map(|&i| elements[i]).collect(), faces, clusters, patches: None }
}

/// The order of these elements in their hierarchy, as indices into `elements`, and the hierarchy.
pub fn hierarchy(elements: &[Element]) -> (Vec<usize>, ClusterTree) {
    let mut builder = Builder { elements, order: vec![], clusters: vec![] };
    let mut sides = face_sides(elements);
    if !sides.is_empty() {
        builder.halve_sides(&mut sides);
    }
    let Builder { order, clusters, .. } = builder;
    let areas: Vec<f64> = order.iter().map(|&i| elements[i].area).collect();
    let count = order.len() as u32;
    let number = |node: &Branch| match *node {
        Branch::Element(position) => position,
        Branch::Cluster(number) => count + number,
    };
    let children = clusters.iter().map(|pair| [number(&pair[0]), number(&pair[1])]).collect();
    let clusters = ClusterTree::new(&areas, children).expect("the halves make a tree");
    (order, clusters)
}

/// Elements of one side of one face.
struct SideElements {
    elements: Vec<usize>,
    centre: DVec3,
}

fn face_sides(elements: &[Element]) -> Vec<SideElements> {
    let mut fronts: HashMap<u32, DVec3> = HashMap::new();
    let mut boxes: HashMap<u32, Aabb> = HashMap::new();
    for Element { face, normal, centroid, .. } in elements {
        fronts.entry(face.0).or_insert(*normal);
        let around = boxes.entry(face.0).or_insert(Aabb::EMPTY);
        *around = around.union(Aabb::around([centroid]));
    }
    let index = RayIndex::new(elements);
    let is_covered = |e: &Element| {
        let near = COVERED_WITHIN * boxes[&e.face.0].diagonal();
        index.first_hit(e.centroid, e.normal).is_some_and(|hit| hit.distance < near)
    };
    // Elements of one face can differ in light: a lamp set into a ceiling, the floor beneath a crate.
    let key = |e: &Element| (e.face, fronts[&e.face.0].dot(e.normal) < 0.0, e.material, is_covered(e));
    let keys: Vec<_> = elements.iter().map(key).collect();
    let mut order: Vec<usize> = (0..elements.len()).collect();
    order.sort_by_key(|&i| (keys[i], i));
    let side = |run: &[usize]| SideElements {
        elements: run.to_vec(),
        centre: run.iter().map(|&i| elements[i].centroid).sum::<DVec3>() / run.len() as f64,
    };
    order.chunk_by(|&a, &b| keys[a] == keys[b]).map(side).collect()
}

#[derive(Clone, Copy)]
enum Branch {
    Element(u32),
    Cluster(u32),
}

struct Builder<'a> {
    elements: &'a [Element],
    order: Vec<usize>,
    clusters: Vec<[Branch; 2]>,
}

impl Builder<'_> {
    fn halve_sides(&mut self, sides: &mut [SideElements]) -> Branch {
        if let [side] = sides {
            let mut elements = std::mem::take(&mut side.elements);
            let (u, v) = face_axes(&self.elements[elements[0]]);
            return self.halve_elements(&mut elements, &[u, v]);
        }
        let axis = longest(&DVec3::AXES, sides.iter().map(|side| side.centre));
        sides.sort_by(|a, b| a.centre.dot(axis).total_cmp(&b.centre.dot(axis)));
        let middle = sides.len() / 2;
        let (left, right) = sides.split_at_mut(middle);
        self.cluster(|builder| builder.halve_sides(left), |builder| builder.halve_sides(right))
    }

    fn halve_elements(&mut self, elements: &mut [usize], axes: &[DVec3]) -> Branch {
        if let [element] = elements {
            self.order.push(*element);
            return Branch::Element(self.order.len() as u32 - 1);
        }
        let all = self.elements;
        let axis = longest(axes, elements.iter().map(|&i| all[i].centroid));
        let place = |i: usize| all[i].centroid.dot(axis);
        elements.sort_by(|&a, &b| place(a).total_cmp(&place(b)).then(a.cmp(&b)));
        let places: Vec<f64> = elements.iter().map(|&i| place(i)).collect();
        let (left, right) = elements.split_at_mut(grid_line(&places));
        self.cluster(
            |builder| builder.halve_elements(left, axes),
            |builder| builder.halve_elements(right, axes),
        )
    }

    fn cluster(
        &mut self,
        left: impl FnOnce(&mut Self) -> Branch,
        right: impl FnOnce(&mut Self) -> Branch,
    ) -> Branch {
        let number = self.clusters.len();
        // Reserve the number before the halves reserve theirs; the halves are filled in afterwards.
        self.clusters.push([Branch::Cluster(0); 2]);
        let pair = [left(self), right(self)];
        self.clusters[number] = pair;
        Branch::Cluster(number as u32)
    }
}

/// Two axes in the element's plane along the grid it may belong to.
fn face_axes(element: &Element) -> (DVec3, DVec3) {
    let corners = element.corners.as_slice();
    let u = (corners[1] - corners[0]).normalize();
    (u, element.normal.cross(u))
}

fn longest(axes: &[DVec3], places: impl Iterator<Item = DVec3> + Clone) -> DVec3 {
    let extent = |axis: DVec3| {
        let along = places.clone().map(|p| p.dot(axis));
        let (low, high) = along.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), d| (l.min(d), h.max(d)));
        high - low
    };
    // Axes earlier in the list win ties by rounding.
    let mut best = (axes[0], extent(axes[0]));
    for &axis in &axes[1..] {
        let extent = extent(axis);
        if extent > best.1 * (1.0 + SAME_LINE) {
            best = (axis, extent);
        }
    }
    best.0
}

/// Where to divide the sorted positions: at the grid line nearest to the middle, or else in the middle.
fn grid_line(places: &[f64]) -> usize {
    let (count, middle) = (places.len(), places.len() / 2);
    let step = SAME_LINE * (places[count - 1] - places[0]);
    let is_line = |k: usize| k > 0 && k < count && places[k] - places[k - 1] > step;
    (0..=middle).flat_map(|off| [middle - off, middle + off]).find(|&k| is_line(k)).unwrap_or(middle)
}
