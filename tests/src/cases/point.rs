//! The form factor from a point to a surface, computed by rows and by the plain kernel, which must agree.

use crate::shapes::{coupling, grey, mesh, part, rectangle, triangle};
use equilux_bake::form_factor::plain;
use equilux_bake::treecode::EXACT;
use equilux_bake::world::World;
use equilux_formats::Part;
use glam::{DAffine3, DVec3};
use std::f64::consts::PI;

/// A tiny triangle around `point`, looking along `normal`: the receiver.
pub fn receiver(point: DVec3, normal: DVec3) -> Part {
    let (u, v) = normal.any_orthonormal_pair();
    let corners = [0.0f64, 1.0, 2.0].map(|k| {
        let angle = k * 2.0 * PI / 3.0;
        point + (u * angle.cos() + v * angle.sin()) * 1e-3
    });
    triangle(part(grey(0.5, 0.0)), corners)
}

/// The rectangle from `low` to `high`, which agree in one coordinate; its front looks along `normal`.
pub fn facing(low: DVec3, high: DVec3, normal: DVec3) -> Part {
    let span = high - low;
    let axes: Vec<DVec3> =
        DVec3::AXES.into_iter().map(|axis| axis * span.dot(axis)).filter(|a| *a != DVec3::ZERO).collect();
    let (u, v) =
        if axes[0].cross(axes[1]).dot(normal) > 0.0 { (axes[0], axes[1]) } else { (axes[1], axes[0]) };
    rectangle(part(grey(0.5, 0.0)), low, u, v)
}

/// Σ F over the elements of the second part seen from the first, with the other parts in the way; by rows, after
/// checking the plain kernel against them.
pub fn seen(parts: &[Part]) -> f64 {
    let geometries: Vec<_> = parts.iter().map(mesh).collect();
    let world = World::new(geometries.iter().map(|g| (g, DAffine3::IDENTITY)));
    let senders = world.elements_of(1);
    let by_row: f64 = coupling(&world, 0, &[1], EXACT).row_sum(0);
    let by_pair: f64 = senders.map(|sender| plain::form_factor(&world, 0, sender)).sum();
    assert!((by_row - by_pair).abs() <= 1e-15, "row {by_row}, plain {by_pair}");
    by_row
}
