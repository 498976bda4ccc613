//! Coordinates that start near the scene: what is far from the file's origin keeps its digits.
//!
//! Tolerances are shares of the largest coordinate, because that is what rounding is a share of. A scene a thousand
//! kilometres from its file's origin would have tolerances of metres.

use super::bounds::placed_bounds;
use crate::geometry::aabb::Aabb;
use equilux_formats::Scene;

/// A scene is moved once it is further away than about this many times its extent. A power of two.
const FAR: f64 = 16.0;

/// Moves a scene that is far away from its file's origin close to its own, which it keeps in `origin`.
pub(super) fn recentre(scene: &mut Scene) {
    let boxes = scene.instances.iter().map(|instance| placed_bounds(&scene.parts, instance));
    let around = boxes.fold(Aabb::EMPTY, Aabb::union);
    let extent = around.size().max_element();
    if !(extent > 0.0 && extent.is_finite()) {
        return;
    }
    // Whole multiples of a power of two are subtracted without rounding.
    let step = 2f64.powi((FAR * extent).log2().ceil() as i32);
    let origin = (around.centre() / step).round() * step;
    scene.instances.iter_mut().for_each(|instance| instance.placement.translation -= origin);
    scene.lights.iter_mut().for_each(|light| light.position -= origin);
    scene.cameras.iter_mut().for_each(|camera| camera.placement.translation -= origin);
    scene.origin = origin + 0.0;
}
