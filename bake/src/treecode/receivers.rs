//! Flat clusters of receivers: elements of one side of one face that look for their senders together.

use crate::form_factor::plain::IN_PLANE;
use crate::form_factor::polygon::{Polygon, convex_hull};
use crate::form_factor::wide::Points;
use crate::world::{Node, World};
use equilux_formats::FaceId;
use glam::DVec3;
use std::ops::Range;

/// At most this many receivers search together: enough to share the search, few enough to share its outcome.
const TOGETHER: usize = 32;

/// The flat clusters of an instance's elements, in order.
pub fn receiver_clusters(world: &World, instance: usize) -> Vec<Range<usize>> {
    let (elements, nodes) = (world.elements_of(instance), world.nodes_of(instance));
    let mut clusters = Vec::new();
    let mut open: Vec<usize> = world.root_of(instance).into_iter().collect();
    let mut next = elements.start;
    while let Some(node) = open.pop() {
        let count = count_elements(world, node);
        match world.nodes[node].children {
            Some([left, right]) if world.nodes[node].side.is_none() || count > TOGETHER => {
                open.extend([right as usize, left as usize]);
            }
            _ => {
                clusters.push(next..next + count);
                next += count;
            }
        }
    }
    assert_eq!(next, elements.end, "every element receives");
    debug_assert!(nodes.len() >= elements.len());
    clusters
}

fn count_elements(world: &World, node: usize) -> usize {
    let mut open = vec![node];
    let mut count = 0;
    while let Some(node) = open.pop() {
        match world.nodes[node].children {
            Some(children) => open.extend(children.map(|c| c as usize)),
            None => count += 1,
        }
    }
    count
}

/// Receivers in one plane that look the same way.
pub struct Receivers {
    /// Their points.
    pub points: Points,
    /// Corners of the convex hull of the points.
    pub hull: Polygon,
    /// Box around the points.
    pub bounds: (DVec3, DVec3),
    /// The face they lie in.
    pub face: FaceId,
    /// The occluder they lie on.
    pub occluder: u32,
    /// Largest extent.
    pub diameter: f64,
}

impl Receivers {
    /// The receivers that a run of elements makes.
    pub fn new(world: &World, elements: Range<usize>) -> Self {
        let first = &world.elements[elements.start];
        let points: Vec<DVec3> = world.elements[elements].iter().map(|e| e.centroid).collect();
        let low = points.iter().copied().fold(DVec3::INFINITY, DVec3::min);
        let high = points.iter().copied().fold(DVec3::NEG_INFINITY, DVec3::max);
        let hull = if points.len() > 4 {
            convex_hull(points.iter().copied(), first.normal)
        } else {
            points.iter().copied().collect()
        };
        Self {
            hull,
            bounds: (low, high),
            face: first.face,
            occluder: world.occluders.of_face[first.face.index()],
            diameter: (high - low).length(),
            points: Points::new(points, first.normal),
        }
    }

    /// Number of receivers.
    pub fn count(&self) -> usize {
        self.points.points().len()
    }

    /// Distance from the box around the receivers to the box around a sender.
    pub fn distance_to(&self, sender: &Node) -> f64 {
        let (low, high) = self.bounds;
        (sender.low - high).max(low - sender.high).max(DVec3::ZERO).length()
    }

    /// Whether a sender lies wholly below the horizon, in the receivers' plane, or turns its back on all of them.
    pub fn cannot_see(&self, sender: &Node, world: &World) -> bool {
        let origin = self.points.points()[0];
        let normal = self.points.normal();
        let (centre, half) = ((sender.low + sender.high) * 0.5, (sender.high - sender.low) * 0.5);
        let reach = (centre - origin).length() + half.length();
        if normal.dot(centre - origin) + normal.abs().dot(half) <= IN_PLANE * reach {
            return true;
        }
        let Some(side) = sender.side else { return false };
        if world.coplanar(side.face, self.face) {
            return true;
        }
        let corner = world.faces[side.face.index()].corners[0];
        self.hull.iter().all(|&p| side.normal.dot(p - corner) <= IN_PLANE * reach)
    }
}
