//! A chart's texels: where they lie on it. In go a chart and a texel size; out comes the affine map between texels and
//! the chart's plane.
//!
//! Texel (i, j) is the square [i, i + 1] × [j, j + 1], rows downwards in the image. The chart's rectangle runs through the
//! **centres** of its outermost texels, so that a lookup anywhere on a rectangular chart is made of the chart's own
//! texels only, its edges show texels that lie on them, and two charts that meet at a whole edge have texels at the same
//! points of it. Around it goes a margin for lookups that reach beyond: on slanted edges, and in smaller images of the
//! lightmap.

use super::bounds::Bounds;
use super::chart::Chart;
use super::patch::{Map, Patch};
use glam::{DVec2, DVec3, dvec2};

/// Texels around a chart that are its own, and get their light from its nearest ones. Two charts are twice as far apart.
pub const MARGIN: u32 = 3;

/// Where a chart's texels lie, in the coordinates of its part.
#[derive(Debug, Clone, PartialEq)]
pub struct Grid {
    /// Texels of the rectangle with its margin.
    pub size: [u32; 2],
    /// A map for each of the chart's planes.
    maps: Vec<Map>,
}

impl Grid {
    /// The grid of `chart` with texels of at most `texel` metres. Its rectangle is the smallest.
    pub fn new(chart: &Chart, texel: f64) -> Self {
        let Bounds { axes, low, extent } = Bounds::of(chart);
        // A needle's hull may be a line.
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

    /// A grid of these maps, one for each of a chart's planes.
    pub fn of_maps(size: [u32; 2], maps: Vec<Map>) -> Self {
        Self { size, maps }
    }

    /// Where a point of one of the chart's planes lies, texels.
    pub fn texel_of(&self, plane: usize, point: DVec3) -> DVec2 {
        self.maps[plane].texel_of(point)
    }

    /// The planes, by number.
    pub fn patches(&self) -> impl Iterator<Item = &Patch> {
        self.maps.iter().map(|map| &map.patch)
    }
}

/// How many texels an extent takes; one that is longer by rounding only does not take another.
fn steps(length: f64, texel: f64) -> u32 {
    // A grid that is too large for any image is refused later; until then it must only not wrap around.
    ((length / texel) * (1.0 - 1e-6)).ceil().clamp(1.0, 1e9) as u32
}
