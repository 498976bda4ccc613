//! Direct light averaged over a piece of surface: that of surfaces by exact form factors at points of a grid that is made
//! finer until the average stays, that of lamps by clipping.

use super::Gather;
use super::faces::Plane;
use super::receiver;
use equilux_bake::equilibrium::added;
use equilux_bake::geometry::aabb::Aabb;
use equilux_bake::geometry::polygon::{Polygon, part};
use equilux_formats::{Element, Rgb};
use glam::DVec3;

/// A planar convex piece of surface, seen from its lit side.
pub struct Piece<'a> {
    /// Corners, counter-clockwise, metres.
    pub corners: &'a [DVec3],
    /// Unit normal.
    pub normal: DVec3,
    /// The faces in its plane.
    pub plane: &'a Plane<'a>,
}

/// Grids of this many cells a side, one after the other.
const GRIDS: [usize; 4] = [1, 2, 4, 8];

/// Of them for reflected light, which has no edges but where things touch.
const COARSE_GRIDS: &[usize] = &[2, 4];

/// A finer grid is taken where the last step changed the average by more than this share. Midpoint rules err by a third of
/// their last change where light is smooth, by less than that change at the edges of shadows.
const STAYS: f64 = 0.01;

impl Gather {
    /// The average direct irradiance of pieces, W/m². Light far below `unit` (W/m²) need not be as exact.
    pub fn direct(&self, pieces: &[Piece], unit: Rgb) -> Vec<Rgb> {
        let mut found = self.glow_over(pieces, unit);
        for lamp in self.lamps() {
            let arriving = lamp.irradiance(self.world(), pieces);
            found.iter_mut().zip(arriving).for_each(|(sum, h)| *sum = added(*sum, h));
        }
        found
    }

    /// The average reflected irradiance of pieces, W/m²: from their middles where nothing stands near, else from grids as
    /// direct light.
    pub fn reflected_over(&self, pieces: &[Piece], unit: Rgb) -> Vec<Rgb> {
        let reflected = |points: &[Element]| self.reflected(points);
        let all: Vec<usize> = (0..pieces.len()).collect();
        let mut found = averages(pieces, &all, 1, &reflected);
        let near: Vec<usize> = all.into_iter().filter(|&number| self.stands_near(&pieces[number])).collect();
        refine(pieces, &mut found, near, COARSE_GRIDS, unit, reflected);
        found
    }

    /// Whether anything stands before a piece at less than its own size.
    fn stands_near(&self, piece: &Piece) -> bool {
        let bounds = Aabb::around(piece.corners);
        self.anything_before(bounds.grown(bounds.diagonal() / 2.0), piece.corners[0], piece.normal)
    }

    fn glow_over(&self, pieces: &[Piece], unit: Rgb) -> Vec<Rgb> {
        let glow = |points: &[Element]| self.glow(points);
        let all: Vec<usize> = (0..pieces.len()).collect();
        let mut found = averages(pieces, &all, GRIDS[0], &glow);
        refine(pieces, &mut found, all, &GRIDS[1..], unit, glow);
        found
    }
}

/// Take finer and finer grids for those of `open` whose average does not stay.
fn refine(
    pieces: &[Piece],
    found: &mut [Rgb],
    mut open: Vec<usize>,
    grids: &[usize],
    unit: Rgb,
    light: impl Fn(&[Element]) -> Vec<Rgb>,
) {
    for &grid in grids {
        let averages = averages(pieces, &open, grid, &light);
        let mut moves = Vec::new();
        for (&number, average) in open.iter().zip(averages) {
            let before = std::mem::replace(&mut found[number], average);
            let stays = |c: usize| (average[c] - before[c]).abs() <= STAYS * average[c].max(0.1 * unit[c]);
            if !(0..3).all(stays) {
                moves.push(number);
            }
        }
        open = moves;
    }
}

/// The averages over grids of some pieces.
fn averages(
    pieces: &[Piece],
    which: &[usize],
    grid: usize,
    light: &impl Fn(&[Element]) -> Vec<Rgb>,
) -> Vec<Rgb> {
    let (mut points, mut weights): (Vec<Element>, Vec<(usize, f64)>) = (vec![], vec![]);
    for (place, &number) in which.iter().enumerate() {
        let piece = &pieces[number];
        let cells: Vec<(DVec3, f64)> =
            cells(piece.corners, grid).iter().map(|cell| centre(cell, piece.normal)).collect();
        let whole: f64 = cells.iter().map(|(_, area)| area).sum();
        for &(centre, area) in &cells {
            let Some(face) = piece.plane.face_at(centre) else { continue };
            points.push(receiver(centre, piece.normal, face));
            // A piece that is no larger than its corners are rounded by has the light of its middle.
            weights.push((place, if whole > 0.0 { area / whole } else { 1.0 / cells.len() as f64 }));
        }
    }
    let mut sums = vec![[0.0; 3]; which.len()];
    for ((place, weight), light) in weights.into_iter().zip(light(&points)) {
        sums[place] = added(sums[place], light.map(|h| h * weight));
    }
    sums
}

/// A polygon cut into a grid of `count` × `count` cells, along its first edge and across it.
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

/// `cell` cut into the strips that `count` equal steps of the extent of `polygon` along an axis make.
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

/// The centre of area of a polygon with this unit normal, and its area.
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
