//! The receivers' side of the search: an instance's elements in a hierarchy, whose leaves are flat clusters of elements
//! that look for their senders together.

use super::viewers::Viewers;
use crate::form_factor::wide::Points;
use crate::world::World;
use std::ops::Range;

/// At most this many receivers search together: enough to share the search, few enough to share its outcome.
const TOGETHER: usize = 32;

/// A node of the receivers' hierarchy.
pub struct Group {
    /// Its elements.
    pub elements: Range<usize>,
    /// Its halves; none if it is a flat cluster.
    pub halves: Option<Box<[Group; 2]>>,
}

/// The hierarchy of an instance's receivers; none if it has no elements.
pub fn receiver_groups(world: &World, instance: usize) -> Option<Group> {
    let mut next = world.elements_of(instance).start;
    let group = world.root_of(instance).map(|root| group(world, root, &mut next));
    assert_eq!(next, world.elements_of(instance).end, "every element receives");
    group
}

/// The group of a node whose first element is `next`, which moves on past its last. Elements are numbered as the
/// hierarchy orders them.
fn group(world: &World, node: usize, next: &mut usize) -> Group {
    let start = *next;
    let Some([left, right]) = world.nodes[node].children else {
        *next += 1;
        return Group { elements: start..*next, halves: None };
    };
    let halves = [group(world, left as usize, next), group(world, right as usize, next)];
    let elements = start..*next;
    let is_cluster = world.nodes[node].side.is_some() && elements.len() <= TOGETHER;
    Group { elements, halves: (!is_cluster).then(|| Box::new(halves)) }
}

/// Receivers in one plane that look the same way.
pub struct Receivers {
    /// Their points.
    pub points: Points,
    /// What the search needs to know of them.
    pub viewers: Viewers,
}

impl Receivers {
    /// The receivers that a run of elements on one side of one face makes.
    pub fn new(world: &World, elements: Range<usize>) -> Self {
        let elements = &world.elements[elements];
        let points = elements.iter().map(|e| e.centroid).collect();
        Self { points: Points::new(points, elements[0].normal), viewers: Viewers::new(world, elements) }
    }

    /// Number of receivers.
    pub fn count(&self) -> usize {
        self.points.points().len()
    }
}
