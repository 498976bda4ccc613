//! A chart's texels: where they lie on it. In go a chart and a texel size; out comes the affine map between texels and
//! the chart's plane.
//!
//! Texel (i, j) is the square [i, i + 1] × [j, j + 1], rows downwards in the image. The chart's rectangle runs through the
//! **centres** of its outermost texels, so that a lookup anywhere on a rectangular chart is made of the chart's own
//! texels only, its edges show texels that lie on them, and two charts that meet at a whole edge have texels at the same
//! points of it. Around it goes a margin for lookups that reach beyond: on slanted edges, and in smaller images of the
//! lightmap.

use super::chart::Chart;
use equilux_bake::form_factor::polygon::convex_hull;
use glam::{DAffine3, DVec2, DVec3, dvec2};

/// Texels around a chart that are its own, and get their light from its nearest ones. Two charts are twice as far apart.
pub const MARGIN: u32 = 3;

/// Where a chart's texels lie, in the coordinates of its part.
#[derive(Debug, Clone, PartialEq)]
pub struct Grid {
    /// Unit vector from which the chart is seen; u × v.
    direction: DVec3,
    /// Unit vectors along rows and columns.
    axes: [DVec3; 2],
    /// The chart's lowest coordinates along the axes, metres.
    low: DVec2,
    /// The distances of texels, metres.
    step: DVec2,
    /// Texels of the rectangle with its margin.
    pub size: [u32; 2],
}

impl Grid {
    /// The grid of `chart` with texels of at most `texel` metres. Its rectangle is the smallest.
    pub fn new(chart: &Chart, texel: f64) -> Self {
        let Bounds { axes, low, extent } = Bounds::of(chart);
        // A needle's hull may be a line.
        let extent = extent.max(DVec2::splat(extent.max_element() * f64::EPSILON));
        let steps = extent.to_array().map(|length| steps(length, texel));
        let size = steps.map(|steps| steps + 1 + 2 * MARGIN);
        let step = extent / dvec2(f64::from(steps[0]), f64::from(steps[1]));
        Self { direction: chart.direction, axes, low, step, size }
    }

    /// Where a point of the chart lies, texels.
    pub fn texel_of(&self, point: DVec3) -> DVec2 {
        let [u, v] = self.axes;
        (dvec2(point.dot(u), point.dot(v)) - self.low) / self.step + f64::from(MARGIN) + 0.5
    }

    /// The points of the plane through `point` with this normal, as an affine function of their texel.
    pub fn patch(&self, point: DVec3, normal: DVec3) -> Patch {
        let facing = normal.dot(self.direction);
        let onto = |p: DVec3| p - self.direction * (p.dot(normal) / facing);
        let corner = self.low - self.step * (f64::from(MARGIN) + 0.5);
        let flat = self.axes[0] * corner.x + self.axes[1] * corner.y;
        Patch {
            origin: point + onto(flat - point),
            du: onto(self.axes[0]) * self.step.x,
            dv: onto(self.axes[1]) * self.step.y,
            normal,
        }
    }
}

/// A piece of plane that texels lie in: texel coordinates (x, y) are the point `origin` + x·`du` + y·`dv`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Patch {
    /// The corner of the grid, metres.
    pub origin: DVec3,
    /// One texel along a row, metres.
    pub du: DVec3,
    /// One texel along a column, metres.
    pub dv: DVec3,
    /// Unit normal of the lit side.
    pub normal: DVec3,
}

impl Patch {
    /// The point at a texel's coordinates, metres.
    pub fn point(&self, texel: DVec2) -> DVec3 {
        self.origin + self.du * texel.x + self.dv * texel.y
    }

    /// The patch after `placement`, a similarity.
    pub fn placed(&self, placement: DAffine3) -> Self {
        let vector = |v| placement.transform_vector3(v);
        Self {
            origin: placement.transform_point3(self.origin),
            du: vector(self.du),
            dv: vector(self.dv),
            normal: vector(self.normal).normalize(),
        }
    }
}

/// How many texels an extent takes; one that is longer by rounding only does not take another.
fn steps(length: f64, texel: f64) -> u32 {
    // A grid that is too large for any image is refused later; until then it must only not wrap around.
    ((length / texel) * (1.0 - 1e-6)).ceil().clamp(1.0, 1e9) as u32
}

/// The rectangle around a chart in its plane, turned so that its area is smallest.
pub struct Bounds {
    axes: [DVec3; 2],
    low: DVec2,
    /// Metres.
    pub extent: DVec2,
}

impl Bounds {
    /// The smallest rectangle: one of its edges lies on an edge of the convex hull (Freeman & Shapira 1975). Of equal
    /// ones that on the longest edge.
    pub fn of(chart: &Chart) -> Self {
        let corners = chart.sides.iter().flat_map(|side| side.corners.as_slice());
        let flat = corners.map(|&p| p - chart.direction * p.dot(chart.direction));
        let hull = convex_hull(flat, chart.direction);
        let edges = (0..hull.len()).map(|i| hull[(i + 1) % hull.len()] - hull[i]);
        let mut best: Option<(Self, f64)> = None;
        for edge in edges {
            let bounds = Self::along(edge.normalize(), chart.direction, &hull);
            let better = best.as_ref().is_none_or(|(best, length)| {
                let [new, old] = [bounds.extent, best.extent].map(|e| e.x * e.y);
                new < old * (1.0 - 1e-9)
                    || (new < old * (1.0 + 1e-9) && edge.length() > length * (1.0 + 1e-9))
            });
            if better {
                best = Some((bounds, edge.length()));
            }
        }
        best.expect("a side has an area").0
    }

    fn along(u: DVec3, direction: DVec3, points: &[DVec3]) -> Self {
        let v = direction.cross(u);
        let flat = || points.iter().map(|p| dvec2(p.dot(u), p.dot(v)));
        let (low, high) =
            (flat().fold(DVec2::INFINITY, DVec2::min), flat().fold(DVec2::NEG_INFINITY, DVec2::max));
        Self { axes: [u, v], low, extent: high - low }
    }
}
