//! Moves coordinates near the origin, so that scenes far from the file's origin keep their digits.
//!
//! Tolerances are relative to the largest coordinate, because rounding is. A scene a thousand
//! kilometres from its file's origin would have tolerances of metres.

use super::bounds::placed_bounds;
use crate::geometry::aabb::Aabb;
use equilux_formats::Scene;

/// A scene is moved if it is further away than about this multiple of its extent. A power of two.
const FAR_EXTENTS: f64 = 16.0;

/// Moves a scene far from its file's origin close to its own, which is stored in `origin`.
pub(super) fn recentre(scene: &mut Scene) {
    let boxes = scene.instances.iter().map(|instance| placed_bounds(&scene.parts, instance));
    let around = boxes.fold(Aabb::EMPTY, Aabb::union);
    let extent = around.size().max_element();
    if !(extent > 0.0 && extent.is_finite()) {
        return;
    }
    // Whole multiples of a power of two are subtracted without rounding.
    let step = 2f64.powi((FAR_EXTENTS * extent).log2().ceil() as i32);
    let origin = (around.centre() / step).round() * step;
    scene.instances.iter_mut().for_each(|instance| instance.placement.translation -= origin);
    scene.lights.iter_mut().for_each(|light| light.position -= origin);
    scene.cameras.iter_mut().for_each(|camera| camera.placement.translation -= origin);
    scene.origin = origin + 0.0;
}
