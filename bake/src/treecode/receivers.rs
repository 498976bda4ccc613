//! The hierarchy of receivers. Its leaves are flat clusters of elements that share one search for senders.

use super::request::Audience;
use super::viewers::Viewers;
use crate::form_factor::wide::Points;
use crate::world::World;
use equilux_formats::Element;
use std::ops::Range;

/// The largest number of receivers that share a search: enough to share its cost, few enough to share its result.
const MAX_GROUP_RECEIVERS: usize = 32;

/// A node of the receivers' hierarchy.
pub struct Group {
    /// Its elements, as indices among the receivers.
    pub elements: Range<usize>,
    /// Its halves; none if it is a flat cluster.
    pub halves: Option<Box<[Group; 2]>>,
}

/// The hierarchy of receivers; none if there are none.
pub fn receiver_groups(world: &World, audience: Audience) -> Option<Group> {
    let instance = match audience {
        Audience::Instance(instance) => instance,
        Audience::Points([]) => return None,
        Audience::Points(points) => return Some(halved(points, 0..points.len())),
    };
    let mut next = 0;
    let group = world.root_of(instance).map(|root| group(world, root, &mut next));
    assert_eq!(next, world.elements_of(instance).len(), "every element receives");
    group
}

/// The group of points in a range, halved down to flat clusters.
fn halved(points: &[Element], range: Range<usize>) -> Group {
    let own = &points[range.clone()];
    let is_flat = own.iter().all(|e| e.face == own[0].face && e.normal.dot(own[0].normal) > 0.0);
    let halves = (!is_flat || own.len() > MAX_GROUP_RECEIVERS).then(|| {
        let middle = range.start + own.len() / 2;
        Box::new([halved(points, range.start..middle), halved(points, middle..range.end)])
    });
    Group { elements: range, halves }
}

/// The group of a node whose first element is `next`, which is then moved past its last element. Elements are numbered
/// in the order of the hierarchy.
fn group(world: &World, node: usize, next: &mut usize) -> Group {
    let start = *next;
    let Some([left, right]) = world.nodes[node].children else {
        *next += 1;
        return Group { elements: start..*next, halves: None };
    };
    let halves = [group(world, left as usize, next), group(world, right as usize, next)];
    let elements = start..*next;
    let is_cluster = world.nodes[node].side.is_some() && elements.len() <= MAX_GROUP_RECEIVERS;
    Group { elements, halves: (!is_cluster).then(|| Box::new(halves)) }
}

/// Receivers in one plane that face the same way.
pub struct Receivers {
    /// Their points.
    pub points: Points,
    /// Their extent and orientation, for the search.
    pub viewers: Viewers,
}

impl Receivers {
    /// The receivers at the centroids of these elements, which lie on one side of one face.
    pub fn new(world: &World, elements: &[Element]) -> Self {
        let points = elements.iter().map(|e| e.centroid).collect();
        Self { points: Points::new(points, elements[0].normal), viewers: Viewers::new(world, elements) }
    }

    /// Number of receivers.
    pub fn count(&self) -> usize {
        self.points.points().len()
    }
}
