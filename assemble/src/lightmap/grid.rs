//! The texel grid of a chart. Input: a chart and a texel size. Output: the affine map between texels and the chart's
//! plane.
//!
//! Texel (i, j) is the square [i, i + 1] × [j, j + 1], with rows downwards in the image. The chart's rectangle passes
//! through the **centres** of its outermost texels. Lookups on a rectangular chart therefore use only the chart's own
//! texels, its edges show texels that lie on them, and two charts that meet along a whole edge have texels at the
//! same points of it. A margin around the rectangle serves lookups beyond it: on slanted edges, and in smaller images
//! of the lightmap.

use super::bounds::Bounds;
use super::chart::Chart;
use super::patch::{Map, Patch};
use glam::{DVec2, DVec3, dvec2};

/// Width of the margin around a chart, texels. Two charts are twice as far apart.
pub const MARGIN: u32 = 3;

/// The positions of a chart's texels, in the coordinates of its part.
#[derive(Debug, Clone, PartialEq)]
pub struct Grid {
    /// Size of the rectangle with its margin, texels.
    pub size: [u32; 2],
    /// A map for each of the chart's planes.
    maps: Vec<Map>,
}

impl Grid {
    /// The grid of `chart` on its smallest rectangle, with texels of at most `texel` metres.
    pub fn new(chart: &Chart, texel: f64) -> Self {
        let Bounds { axes, low, extent } = Bounds::of(chart);
        // The hull of a very thin chart may be a line.
        let extent = extent.max(DVec2::splat(extent.max_element() * f64::EPSILON));
        let steps = extent.to_array().map(|length| steps(length, texel));
        let step = extent / dvec2(f64::from(steps[0]), f64::from(steps[1]));
        let first = DVec2::splat(f64::from(MARGIN) + 0.5);
        let map = |plane: usize| {
            let side = chart.largest_in(plane);
            let point = side.corners.as_slice()[0];
            Map::along(chart.direction, axes, [low, step, first], point, side.normal)
        };
        let size = steps.map(|steps| steps + 1 + 2 * MARGIN);
        Self { size, maps: (0..chart.plane_count()).map(map).collect() }
    }

    /// A grid of these maps, one for each plane of a chart.
    pub fn of_maps(size: [u32; 2], maps: Vec<Map>) -> Self {
        Self { size, maps }
    }

    /// The texel coordinates of a point in one of the chart's planes.
    pub fn texel_of(&self, plane: usize, point: DVec3) -> DVec2 {
        self.maps[plane].texel_of(point)
    }

    /// The planes in order.
    pub fn patches(&self) -> impl Iterator<Item = &Patch> {
        self.maps.iter().map(|map| &map.patch)
    }
}

/// Number of texels for an extent; excess lengths due to rounding do not add a texel.
fn steps(length: f64, texel: f64) -> u32 {
    // A grid that is too large for any image is rejected later; here it must only not overflow.
    ((length / texel) * (1.0 - 1e-6)).ceil().clamp(1.0, 1e9) as u32
}
