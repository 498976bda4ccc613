//! Boxes around parts and instances.

use crate::geometry::aabb::Aabb;
use equilux_formats::{Instance, Part};

/// The box around a part, in its own coordinates.
pub(super) fn part_bounds(part: &Part) -> Aabb {
    Aabb::around(part.surfaces.iter().flat_map(|surface| surface.corners.as_slice()))
}

/// A box around an instance, in scene coordinates: that of its part's box.
pub(super) fn placed_bounds(parts: &[Part], instance: &Instance) -> Aabb {
    let own = part_bounds(&parts[instance.part.index()]);
    let matrix = instance.placement.matrix3;
    let centre = instance.placement.transform_point3(own.centre());
    let half = own.size() / 2.0;
    let reach = matrix.x_axis.abs() * half.x + matrix.y_axis.abs() * half.y + matrix.z_axis.abs() * half.z;
    Aabb { low: centre - reach, high: centre + reach }
}
