//! F_ij = (1/π) ∫_{S_j} V(x_i,y) cosθ_i cosθ_j / |x_i−y|² dy, computed directly.
//!
//! Every occluder hides a pyramid from the receiver's point x_i. The sender polygon minus all pyramids is integrated
//! exactly. There is no acceleration and no sharing between pairs: tests compare the faster methods with this one.

use super::contour;
use crate::geometry::outline::Plane;
use crate::geometry::polygon::{Clipped, Polygon, Pyramid, clip};
use crate::geometry::tolerance::IN_PLANE;
use crate::world::World;
use equilux_formats::{Element, Face, FaceId};
use glam::DVec3;

/// The form factor from element `receiver` to element `sender` of `world`, occluded by all faces; without unit, 0..1.
/// Faces in the plane of the receiver or the sender do not occlude.
pub fn form_factor(world: &World, receiver: usize, sender: usize) -> f64 {
    let (receiver, sender) = (&world.elements[receiver], &world.elements[sender]);
    let ends = [receiver.face, sender.face];
    if world.coplanar(ends[0], ends[1]) {
        return 0.0;
    }
    let Some(polygon) = visible_side(receiver, sender) else { return 0.0 };
    let mut pieces = vec![polygon];
    for (number, occluder) in world.faces.iter().enumerate() {
        if ends.iter().any(|&end| world.coplanar(end, FaceId::from_index(number))) {
            continue;
        }
        let before = Plane { normal: sender.normal, point: sender.corners.as_slice()[0] };
        let Some(pyramid) = hidden_pyramid(receiver.centroid, occluder, before) else { continue };
        let mut outside = Vec::with_capacity(pieces.len());
        for piece in pieces {
            pyramid.subtract_from(piece, &mut outside);
        }
        pieces = outside;
    }
    pieces.iter().map(|piece| contour::form_factor(piece, receiver.normal)).sum()
}

/// The sender's polygon relative to the receiver's point, cut off at the receiver's horizon; none if the sender faces
/// away, or one lies in the other's plane.
pub fn visible_side(receiver: &Element, sender: &Element) -> Option<Polygon> {
    let x = receiver.centroid;
    let polygon: Polygon = sender.corners.as_slice().iter().map(|&p| p - x).collect();
    let reach = polygon.iter().map(|p| p.length()).fold(0.0, f64::max);
    if -sender.normal.dot(polygon[0]) <= IN_PLANE * reach {
        return None;
    }
    if polygon.iter().all(|&p| receiver.normal.dot(p) <= IN_PLANE * reach) {
        return None;
    }
    match clip(&polygon, |p| receiver.normal.dot(p)) {
        Clipped::All => Some(polygon),
        Clipped::None => None,
        Clipped::Piece(piece) => Some(piece),
    }
}

/// The pyramid that `occluder` hides, from the point `x`, of a sender in the plane `of`; none if the occluder lies
/// behind that plane or is seen edge-on.
pub fn hidden_pyramid(x: DVec3, occluder: &Face, of: Plane) -> Option<Pyramid> {
    let polygon: Polygon = occluder.corners.iter().map(|&p| p - x).collect();
    let reach = polygon.iter().map(|p| p.length()).fold(0.0, f64::max);
    if occluder.normal.dot(polygon[0]).abs() <= IN_PLANE * reach {
        return None;
    }
    // Only the part between x and the sender's plane can hide the sender.
    let on_plane = of.point - x;
    let before_sender = |p: DVec3| of.normal.dot(p - on_plane);
    if polygon.iter().all(|&p| before_sender(p) <= IN_PLANE * reach) {
        return None;
    }
    match clip(&polygon, before_sender) {
        Clipped::All => Some(Pyramid::over(&polygon, occluder.normal)),
        Clipped::None => None,
        Clipped::Piece(piece) => Some(Pyramid::over(&piece, occluder.normal)),
    }
}
