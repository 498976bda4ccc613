//! Planar convex pieces of surface, their grids and their centres.

use crate::gather::faces::CoplanarFaces;
use equilux_bake::geometry::polygon::{Polygon, part};
use glam::DVec3;

/// A planar convex piece of surface with its lit side.
#[derive(Debug)]
pub struct SurfacePiece<'a> {
    /// Corners, counter-clockwise, metres.
    pub corners: &'a [DVec3],
    /// Unit normal.
    pub normal: DVec3,
    /// The faces in its plane.
    pub plane: &'a CoplanarFaces<'a>,
}

/// Divide a polygon into a grid of `count` × `count` cells, along its first edge and across it.
pub fn cells(polygon: &[DVec3], count: usize) -> Vec<Polygon> {
    let whole: Polygon = polygon.iter().copied().collect();
    if count == 1 {
        return vec![whole];
    }
    let along = (polygon[1] - polygon[0]).normalize_or_zero();
    let last = polygon[polygon.len() - 1] - polygon[0];
    let across = (last - along * last.dot(along)).normalize_or_zero();
    let mut cells = vec![whole];
    for axis in [along, across] {
        cells = cells.into_iter().flat_map(|cell| strips(cell, polygon, axis, count)).collect();
    }
    cells
}

/// Divide `cell` into the strips given by `count` equal steps of the extent of `polygon` along an axis.
fn strips(cell: Polygon, polygon: &[DVec3], axis: DVec3, count: usize) -> Vec<Polygon> {
    let along = |p: DVec3| axis.dot(p - polygon[0]);
    let extent = polygon.iter().map(|&p| along(p));
    let (low, high) = extent.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), d| (l.min(d), h.max(d)));
    let mut rest = Some(cell);
    let mut strips = Vec::new();
    for line in 1..count {
        let Some(left) = rest.take() else { break };
        let at = low + (high - low) * line as f64 / count as f64;
        let [strip, beyond] = part(&left, |p| at - along(p));
        strips.extend(strip);
        rest = beyond;
    }
    strips.extend(rest);
    strips
}

/// The centroid and the area of a polygon with this unit normal.
pub fn centre(polygon: &[DVec3], normal: DVec3) -> (DVec3, f64) {
    let origin = polygon[0];
    let (mut sum, mut double) = (DVec3::ZERO, 0.0);
    for edge in polygon.windows(2).skip(1) {
        let (a, b) = (edge[0] - origin, edge[1] - origin);
        let area = a.cross(b).dot(normal);
        sum += (a + b) * area;
        double += area;
    }
    if double <= 0.0 {
        return (polygon.iter().sum::<DVec3>() / polygon.len() as f64, 0.0);
    }
    (origin + sum / (3.0 * double), double / 2.0)
}
