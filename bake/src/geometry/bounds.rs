//! Boxes along the axes.

use super::polygon::Polygon;
use glam::DVec3;

/// The corners of a box.
pub fn box_corners(low: DVec3, high: DVec3) -> Polygon {
    (0..8)
        .map(|k| {
            let pick = |bit: usize, axis: usize| if k >> bit & 1 == 0 { low[axis] } else { high[axis] };
            DVec3::new(pick(0, 0), pick(1, 1), pick(2, 2))
        })
        .collect()
}
