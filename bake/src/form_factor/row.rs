//! Rows of exact form factors. What is the same for all elements of a sender face is done once for the face: the
//! search for occluders and the pyramids they hide. Elements are then clipped one by one, as in [`super::plain`].

use super::contour;
use super::plain::{IN_PLANE, hidden_pyramid, visible_side};
use super::polygon::{Polygon, Pyramid};
use crate::world::World;
use equilux_formats::Element;
use glam::DVec3;
use std::ops::Range;

/// The row of `receiver`: (sender, form factor) for every element of `senders` it sees, counted from the beginning of
/// that range, by rising sender. Everything in `world` blocks.
pub fn row(world: &World, receiver: usize, senders: Range<usize>) -> Vec<(u32, f64)> {
    let mut row = Vec::new();
    let mut scratch = Scratch::default();
    let first = world.groups.partition_point(|group| group.end <= senders.start);
    for group in world.groups[first..].iter().take_while(|group| group.start < senders.end) {
        add_group(world, receiver, group.clone(), senders.start, &mut scratch, &mut row);
    }
    row
}

/// Buffers that live as long as the row.
#[derive(Default)]
struct Scratch {
    candidates: Vec<u32>,
    pyramids: Vec<Pyramid>,
    pieces: Vec<Polygon>,
    outside: Vec<Polygon>,
}

fn add_group(
    world: &World,
    receiver: usize,
    group: Range<usize>,
    base: usize,
    scratch: &mut Scratch,
    row: &mut Vec<(u32, f64)>,
) {
    let from = &world.elements[receiver];
    let (own, other) = (from.face.index(), world.elements[group.start].face.index());
    if world.planes[own] == world.planes[other] || !may_see(from, world, group.start) {
        return;
    }
    find_pyramids(world, from, group.start, scratch);
    for sender in group {
        let value = element_form_factor(from, &world.elements[sender], scratch);
        if value != 0.0 {
            row.push(((sender - base) as u32, value));
        }
    }
}

/// Whether the receiver's point lies before the face and any of the face above the receiver's horizon.
fn may_see(receiver: &Element, world: &World, sender: usize) -> bool {
    let face = &world.faces[world.elements[sender].face.index()];
    let before = world.elements[sender].normal.dot(receiver.centroid - face.corners[0]);
    before > 0.0 && face.corners.iter().any(|&p| receiver.normal.dot(p - receiver.centroid) > 0.0)
}

/// The pyramids of all faces that can stand between the receiver's point and the sender's face.
fn find_pyramids(world: &World, receiver: &Element, sender: usize, scratch: &mut Scratch) {
    let (x, sender) = (receiver.centroid, &world.elements[sender]);
    let face = &world.faces[sender.face.index()];
    let Scratch { candidates, pyramids, .. } = scratch;
    candidates.clear();
    pyramids.clear();
    world.index.candidates(face.corners.iter().copied().chain([x]), candidates);
    let target: Polygon = face.corners.iter().map(|&p| p - x).collect();
    let view = Pyramid::over(&target, face.normal);
    let ends = [world.planes[receiver.face.index()], world.planes[sender.face.index()]];
    for &candidate in candidates.iter() {
        let occluder = &world.faces[candidate as usize];
        if ends.contains(&world.planes[candidate as usize]) || is_aside(receiver, &occluder.corners, &view) {
            continue;
        }
        if let Some(pyramid) = hidden_pyramid(x, occluder, sender)
            && !pyramid.misses(&target)
        {
            pyramids.push(pyramid);
        }
    }
}

/// Whether an occluder lies below the receiver's horizon or beside the view of the sender's face.
fn is_aside(receiver: &Element, occluder: &[DVec3], view: &Pyramid) -> bool {
    let polygon: Polygon = occluder.iter().map(|&p| p - receiver.centroid).collect();
    let reach = polygon.iter().map(|p| p.length()).fold(0.0, f64::max);
    polygon.iter().all(|&p| receiver.normal.dot(p) <= IN_PLANE * reach) || view.misses(&polygon)
}

fn element_form_factor(receiver: &Element, sender: &Element, scratch: &mut Scratch) -> f64 {
    let Some(polygon) = visible_side(receiver, sender) else { return 0.0 };
    let Scratch { pyramids, pieces, outside, .. } = scratch;
    pieces.clear();
    pieces.push(polygon);
    for pyramid in pyramids.iter() {
        outside.clear();
        for piece in pieces.drain(..) {
            pyramid.subtract_from(piece, outside);
        }
        std::mem::swap(pieces, outside);
        if pieces.is_empty() {
            return 0.0;
        }
    }
    pieces.iter().map(|piece| contour::form_factor(piece, receiver.normal)).sum()
}
