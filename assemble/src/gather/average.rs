//! Direct light averaged over a piece of surface: that of surfaces by exact form factors at points of a grid that is made
//! finer until the average stays, that of lamps by clipping.

use crate::gather::Gather;
use crate::gather::receiver::receiver;
use crate::gather::surface_piece::{SurfacePiece, cells, centre};
use equilux_bake::geometry::aabb::Aabb;
use equilux_formats::{Element, Rgb};
use glam::DVec3;

/// Grids of this many cells a side, one after the other.
const GRIDS: [usize; 4] = [1, 2, 4, 8];

/// Of them for reflected light, which has no edges but where things touch.
const COARSE_GRIDS: &[usize] = &[2, 4];

/// A finer grid is taken where the last step changed the average by more than this share. Midpoint rules err by a third of
/// their last change where light is smooth, by less than that change at the edges of shadows.
const STAYS: f64 = 0.01;

impl Gather {
    /// The average direct irradiance of pieces, W/m². Light far below `unit` (W/m²) need not be as exact.
    pub fn direct(&self, pieces: &[SurfacePiece], unit: Rgb) -> Vec<Rgb> {
        let mut found = self.glow_over(pieces, unit);
        for lamp in self.lamps() {
            let arriving = lamp.irradiance(self.world(), pieces);
            found.iter_mut().zip(arriving).for_each(|(sum, h)| *sum += h);
        }
        found
    }

    /// The average reflected irradiance of pieces, W/m²: from their middles where nothing stands near, else from grids as
    /// direct light.
    pub fn reflected_over(&self, pieces: &[SurfacePiece], unit: Rgb) -> Vec<Rgb> {
        let reflected = |points: &[Element]| self.reflected(points);
        let all: Vec<usize> = (0..pieces.len()).collect();
        let mut found = averages(pieces, &all, 1, &reflected);
        let near: Vec<usize> = all.into_iter().filter(|&number| self.stands_near(&pieces[number])).collect();
        refine(pieces, &mut found, near, COARSE_GRIDS, unit, reflected);
        found
    }

    /// Whether anything stands before a piece at less than its own size.
    fn stands_near(&self, piece: &SurfacePiece) -> bool {
        let bounds = Aabb::around(piece.corners);
        self.anything_before(bounds.grown(bounds.diagonal() / 2.0), piece.corners[0], piece.normal)
    }

    fn glow_over(&self, pieces: &[SurfacePiece], unit: Rgb) -> Vec<Rgb> {
        let glow = |points: &[Element]| self.glow(points);
        let all: Vec<usize> = (0..pieces.len()).collect();
        let mut found = averages(pieces, &all, GRIDS[0], &glow);
        refine(pieces, &mut found, all, &GRIDS[1..], unit, glow);
        found
    }
}

/// Take finer and finer grids for those of `open` whose average does not stay.
fn refine(
    pieces: &[SurfacePiece],
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
    pieces: &[SurfacePiece],
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
    let mut sums = vec![Rgb::BLACK; which.len()];
    for ((place, weight), light) in weights.into_iter().zip(light(&points)) {
        sums[place] += light * weight;
    }
    sums
}
