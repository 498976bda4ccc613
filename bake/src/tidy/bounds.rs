//! Boxes around parts, by their lowest and highest corners.

use equilux_formats::{Instance, Part};
use glam::DVec3;

/// The box around a part, in its own coordinates.
pub(super) fn part_bounds(part: &Part) -> (DVec3, DVec3) {
    let corners = || part.surfaces.iter().flat_map(|surface| surface.corners.as_slice()).copied();
    (corners().fold(DVec3::INFINITY, DVec3::min), corners().fold(DVec3::NEG_INFINITY, DVec3::max))
}

/// A box around an instance, in scene coordinates: that of its part's box.
pub(super) fn placed_bounds(parts: &[Part], instance: &Instance) -> (DVec3, DVec3) {
    let (low, high) = part_bounds(&parts[instance.part.index()]);
    let matrix = instance.placement.matrix3;
    let centre = instance.placement.transform_point3((low + high) / 2.0);
    let half = (high - low) / 2.0;
    let reach = matrix.x_axis.abs() * half.x + matrix.y_axis.abs() * half.y + matrix.z_axis.abs() * half.z;
    (centre - reach, centre + reach)
}
