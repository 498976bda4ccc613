//! The form factor of an unoccluded polygon, seen from a point.
//!
//! F = (1/2π) Σ_edges θ_e · (n · (a×b)/|a×b|), where a, b are the edge's ends relative to the receiver's point, θ_e the
//! angle between them and n the receiver's normal. Lambert 1760; Cohen & Wallace 1993, ch. 4.4. Without unit.
//!
//! The sum loses all digits far away, where the edges cancel: from [`FAR`] diameters on a Gauss rule integrates the
//! kernel cosθ_i cosθ_j / (π r²) directly.

use glam::DVec3;
use std::f64::consts::PI;

/// From this many diameters on the Gauss rule is used: there the contour has lost 64² of its 2⁵³, and the rule, of
/// degree five, errs by less than (1/64)⁶.
pub const FAR: f64 = 64.0;

/// Form factor of the polygon `corners` (relative to the receiver's point, above its horizon, counter-clockwise seen
/// from the receiver when listed from the front of the sender), for the receiver normal `normal`.
///
/// The sign follows the order of the corners: positive when the receiver is before the polygon's front.
pub fn form_factor(corners: &[DVec3], normal: DVec3) -> f64 {
    if is_far(corners) { far_form_factor(corners, normal) } else { contour(corners, normal) }
}

fn is_far(corners: &[DVec3]) -> bool {
    let origin = corners[0];
    let radius2 = corners.iter().map(|&p| (p - origin).length_squared()).fold(0.0, f64::max);
    origin.length_squared() > radius2 * (FAR * FAR)
}

/// Lambert's sum over the edges.
pub fn contour(corners: &[DVec3], normal: DVec3) -> f64 {
    let mut sum = 0.0;
    let mut a = corners[corners.len() - 1];
    for &b in corners {
        sum += edge(a, b, normal);
        a = b;
    }
    // Corners counter-clockwise from the sender's front run clockwise around the direction of sight.
    -sum / (2.0 * PI)
}

/// θ · n·(a×b)/|a×b|. The cross product is taken with b − a, so that a short edge far away keeps its digits.
fn edge(a: DVec3, b: DVec3, normal: DVec3) -> f64 {
    let cross = a.cross(b - a);
    let sine = cross.length();
    if sine == 0.0 { 0.0 } else { sine.atan2(a.dot(b)) * (normal.dot(cross) / sine) }
}

/// ∫ cosθ_i cosθ_j / (π r²) over the polygon by Radon's seven points a triangle (degree five, 1948).
fn far_form_factor(corners: &[DVec3], normal: DVec3) -> f64 {
    let origin = corners[0];
    corners.windows(2).skip(1).map(|edge| far_triangle([origin, edge[0], edge[1]], normal)).sum()
}

fn far_triangle([a, b, c]: [DVec3; 3], normal: DVec3) -> f64 {
    let double_area = (b - a).cross(c - a);
    // Both cosines hold a 1/r: n·y and N·(−y) with |N| = twice the area.
    let kernel = |y: DVec3| normal.dot(y) * -double_area.dot(y) / (y.length_squared() * y.length_squared());
    let root = 15.0f64.sqrt();
    let ring = |centre: f64, weight: f64| {
        let off = (1.0 - centre) / 2.0;
        let points = [a * centre + (b + c) * off, b * centre + (c + a) * off, c * centre + (a + b) * off];
        weight * points.into_iter().map(kernel).sum::<f64>()
    };
    let sum = kernel((a + b + c) / 3.0) * (9.0 / 40.0)
        + ring((9.0 + 2.0 * root) / 21.0, (155.0 - root) / 1200.0)
        + ring((9.0 - 2.0 * root) / 21.0, (155.0 + root) / 1200.0);
    sum / (2.0 * PI)
}
