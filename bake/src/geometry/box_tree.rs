//! A bounding volume hierarchy.
//!
//!
//! obvhs builds it in f32; its boxes are then computed again in f64. Results depend on exact clipping only.

use super::aabb::Aabb;
use glam::{DVec3, Vec3A};
use obvhs::aabb::Aabb as Box32;
use obvhs::bvh2::{Bvh2, builder::build_bvh2};
use obvhs::{Boundable, BvhBuildParams};
use std::time::Duration;

/// A binary hierarchy of boxes around items, which callers number.
#[derive(Debug)]
pub struct BoxTree {
    nodes: Vec<BoxNode>,
    things: Vec<u32>,
}

/// A box of the hierarchy.
#[derive(Debug, Clone, Copy)]
pub struct BoxNode {
    /// The box.
    pub bounds: Aabb,
    first: u32,
    /// Number of items of a leaf; 0 in an inner node, whose two children are at `first`.
    count: u32,
}

/// The contents of a box.
#[derive(Debug)]
pub enum Inside<'a> {
    /// Two smaller boxes.
    Boxes([usize; 2]),
    /// The numbers of the items of a leaf.
    Things(&'a [u32]),
}

impl BoxTree {
    /// The hierarchy of items with these boxes.
    pub fn new(boxes: &[Aabb]) -> Self {
        let (centre, padding) = frame(boxes.iter().flat_map(|b| [b.low, b.high]));
        let rounded: Vec<Box3> =
            boxes.iter().map(|b| Box3(bounds(&[b.low, b.high], centre, padding))).collect();
        let Some(bvh) = build(&rounded) else { return Self { nodes: vec![], things: vec![] } };
        let node = |n: &obvhs::bvh2::node::Bvh2Node| BoxNode {
            bounds: Aabb::EMPTY,
            first: n.first_index,
            count: n.prim_count,
        };
        let mut tree = Self { nodes: bvh.nodes.iter().map(node).collect(), things: bvh.primitive_indices };
        tree.fit(0, boxes);
        tree
    }

    /// The index of the box around everything; none if there are no items.
    pub fn root(&self) -> Option<usize> {
        (!self.nodes.is_empty()).then_some(0)
    }

    /// The box at `index`.
    pub fn node(&self, index: usize) -> &BoxNode {
        &self.nodes[index]
    }

    /// The contents of the box at `index`.
    pub fn inside(&self, index: usize) -> Inside<'_> {
        let BoxNode { first, count, .. } = self.nodes[index];
        let first = first as usize;
        if count == 0 {
            Inside::Boxes([first, first + 1])
        } else {
            Inside::Things(&self.things[first..first + count as usize])
        }
    }

    /// The items of all leaves whose boxes intersect `sought`, leaf by leaf.
    pub fn meeting(&self, sought: Aabb) -> Vec<u32> {
        let (mut found, mut open) = (Vec::new(), Vec::from_iter(self.root()));
        while let Some(index) = open.pop() {
            let node = self.node(index);
            if !node.bounds.meets(&sought) {
                continue;
            }
            match self.inside(index) {
                Inside::Boxes(inner) => open.extend(inner),
                Inside::Things(things) => found.extend_from_slice(things),
            }
        }
        found
    }

    fn fit(&mut self, index: usize, boxes: &[Aabb]) -> Aabb {
        let bounds = match self.inside(index) {
            Inside::Things(things) => {
                things.iter().map(|&thing| boxes[thing as usize]).fold(Aabb::EMPTY, Aabb::union)
            }
            Inside::Boxes(inner) => {
                inner.map(|i| self.fit(i, boxes)).into_iter().fold(Aabb::EMPTY, Aabb::union)
            }
        };
        self.nodes[index].bounds = bounds;
        bounds
    }
}

/// A box in f32.
pub(crate) struct Box3(pub Box32);

impl Boundable for Box3 {
    fn aabb(&self) -> Box32 {
        self.0
    }
}

pub(crate) fn build(boxes: &[Box3]) -> Option<Bvh2> {
    let mut time = Duration::ZERO;
    (!boxes.is_empty()).then(|| build_bvh2(boxes, BvhBuildParams::medium_build(), &mut time))
}

/// The centre of all points, and the padding that covers the rounding of their f32 images around it: four units in
/// the last place of the largest coordinate.
pub(crate) fn frame(points: impl Iterator<Item = DVec3> + Clone) -> (DVec3, f32) {
    let around = Aabb::around(points);
    if around.is_empty() {
        return (DVec3::ZERO, 0.0);
    }
    (around.centre(), (around.size().max_element() * 4.0) as f32 * f32::EPSILON)
}

pub(crate) fn bounds(points: &[DVec3], centre: DVec3, padding: f32) -> Box32 {
    let local: Vec<Vec3A> = points.iter().map(|&p| (p - centre).as_vec3a()).collect();
    let around = Box32::from_points(&local);
    Box32::new(around.min - padding, around.max + padding)
}
