//! The texels of a chart. Input: a chart and its grid, in the coordinates of their part, and an instance's placement.
//! Output: texels with their footprints in scene coordinates.

use super::chart::Chart;
use super::grid::Grid;
use super::patch::Patch;
use equilux_bake::geometry::polygon::{Polygon, part};
use equilux_formats::MaterialId;
use glam::{DAffine3, DVec2, DVec3};
use std::collections::BTreeMap;
use std::ops::Range;

/// The texels of a chart of an instance, in scene coordinates, metres.
#[derive(Debug, Clone)]
pub struct Texels {
    /// Index of the instance.
    pub instance: usize,
    /// Material of the chart, as numbered in the part.
    pub material: MaterialId,
    /// The planes of the chart. Texel coordinates count from the corner of the chart's rectangle.
    pub patches: Vec<Patch>,
    /// The texels that hold part of the chart, row after row.
    pub texels: Vec<Texel>,
}

/// A texel that holds part of a chart.
#[derive(Debug, Clone)]
pub struct Texel {
    /// Its column and row in the chart's rectangle.
    pub at: [u32; 2],
    /// The parts of the chart's sides inside its square.
    pub footprints: Vec<TexelFootprint>,
}

/// The planar convex part of a side inside a texel's square.
#[derive(Debug, Clone)]
pub struct TexelFootprint {
    /// Index of the patch in which it lies.
    pub patch: usize,
    /// Index of the chart's side of which it is part.
    pub side: usize,
    /// Corners, counter-clockwise seen from the lit side, metres.
    pub corners: Polygon,
    /// Unit normal of the lit side.
    pub normal: DVec3,
    /// Area, m².
    pub area: f64,
}

impl Texel {
    /// The area of its footprints, m².
    pub fn area(&self) -> f64 {
        self.footprints.iter().map(|footprint| footprint.area).sum()
    }
}

impl Texels {
    /// The texels of `chart` in these `rows` of its rectangle, placed by `placement`, a similarity, as part of
    /// `instance`.
    pub fn new(chart: &Chart, grid: &Grid, rows: Range<u32>, instance: usize, placement: DAffine3) -> Self {
        let patches: Vec<Patch> = grid.patches().copied().collect();
        let mut texels: BTreeMap<[u32; 2], Vec<TexelFootprint>> = BTreeMap::new();
        let determinant = placement.matrix3.determinant();
        let grows = determinant.abs().cbrt().powi(2);
        for (number, (side, &patch)) in chart.sides.iter().zip(&chart.planes).enumerate() {
            let on_plane = &patches[patch];
            let texel = |&p: &DVec3| grid.texel_of(patch, p).extend(0.0);
            let seen: Polygon = side.corners.as_slice().iter().map(texel).collect();
            let normal = placement.transform_vector3(side.normal).normalize();
            // Scaled by the side's own area, however its plane is approximated, so that areas add up to those of the
            // sides.
            let ratio = side.area / area(&seen) * grows;
            if !ratio.is_finite() {
                // A thin triangle that the grid cannot distinguish from a line.
                continue;
            }
            let Some(seen) = between(&seen, &rows) else { continue };
            into_squares(seen, |[column, row], footprint| {
                let area = area(&footprint) * ratio;
                let point = |p: &DVec3| placement.transform_point3(on_plane.point(p.truncate()));
                let mut corners: Polygon = footprint.iter().map(point).collect();
                // The layout may mirror a side, but its corners keep their order; only a mirrored placement reverses
                // it.
                if determinant < 0.0 {
                    corners.reverse();
                }
                texels.entry([row, column]).or_default().push(TexelFootprint {
                    patch,
                    side: number,
                    corners,
                    normal,
                    area,
                });
            });
        }
        let texel = |([row, column], footprints): ([u32; 2], Vec<TexelFootprint>)| Texel {
            at: [column, row],
            footprints,
        };
        Self {
            instance,
            material: chart.material,
            patches: patches.iter().map(|patch| patch.placed(placement)).collect(),
            texels: texels.into_iter().map(texel).collect(),
        }
    }
}

/// Twice the area of a polygon in the plane z = 0.
fn area(polygon: &[DVec3]) -> f64 {
    let from = polygon[0];
    polygon.windows(2).skip(1).map(|edge| (edge[0] - from).cross(edge[1] - from).z).sum()
}

/// Distance within which a point lies on a line between texels, in texels: rounding beyond a line creates no
/// footprint.
const ON_LINE_TOLERANCE: f64 = 1e-9;

/// The distance of a coordinate beyond a line between texels.
fn beyond(coordinate: f64, line: f64) -> f64 {
    let beyond = coordinate - line;
    if beyond.abs() <= ON_LINE_TOLERANCE { 0.0 } else { beyond }
}

/// The part of a polygon in these rows, including the line before them.
fn between(polygon: &[DVec3], rows: &Range<u32>) -> Option<Polygon> {
    let [start, end] = [rows.start, rows.end].map(f64::from);
    let [from_start, _] = part(polygon, |p| beyond(p.y, start));
    let [_, inside] = part(&from_start?, |p| beyond(p.y, end));
    inside
}

/// Divide a polygon along integer coordinates, and `emit` each part with its square.
fn into_squares(polygon: Polygon, mut emit: impl FnMut([u32; 2], Polygon)) {
    slices(polygon, 1, |row, slice| slices(slice, 0, |column, footprint| emit([column, row], footprint)));
}

/// Divide a polygon along integer coordinates of one axis.
fn slices(polygon: Polygon, axis: usize, mut emit: impl FnMut(u32, Polygon)) {
    let reach = |pick: fn(f64, f64) -> f64, start: f64| polygon.iter().map(|p| p[axis]).fold(start, pick);
    let (low, high) = (reach(f64::min, f64::INFINITY), reach(f64::max, f64::NEG_INFINITY));
    let (first, end) = ((low + ON_LINE_TOLERANCE).floor(), (high - ON_LINE_TOLERANCE).ceil());
    let mut rest = Some(polygon);
    let mut line = first;
    while let Some(whole) = rest.take() {
        line += 1.0;
        let number = (line - 1.0) as u32;
        if line >= end {
            return emit(number, whole);
        }
        let [after, below] = part(&whole, |p| beyond(p[axis], line));
        if let Some(below) = below {
            emit(number, below);
        }
        rest = after;
    }
}

/// The four texels around a position in a chart's rectangle, and their weights in a bilinear lookup.
pub fn bilinear(place: DVec2, width: u32) -> [(usize, f64); 4] {
    let corner = (place - 0.5).floor();
    let part = place - 0.5 - corner;
    let index = |x: f64, y: f64| (corner.y + y) as usize * width as usize + (corner.x + x) as usize;
    [
        (index(0.0, 0.0), (1.0 - part.x) * (1.0 - part.y)),
        (index(1.0, 0.0), part.x * (1.0 - part.y)),
        (index(0.0, 1.0), (1.0 - part.x) * part.y),
        (index(1.0, 1.0), part.x * part.y),
    ]
}
