//! The smallest rectangle around a chart, in the chart's plane.

use super::chart::Chart;
use equilux_bake::geometry::polygon::convex_hull;
use glam::{DVec2, DVec3, dvec2};

/// The rectangle of smallest area around a chart, in the chart's plane.
pub struct Bounds {
    /// Unit vectors along its edges; their cross product is the chart's direction.
    pub axes: [DVec3; 2],
    /// Its lowest corner along them, metres.
    pub low: DVec2,
    /// Its extent along them, metres.
    pub extent: DVec2,
}

impl Bounds {
    /// The smallest rectangle, one edge of which lies on an edge of the convex hull (Freeman & Shapira 1975). Among
    /// equal ones, the one on the longest edge.
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
