//! Direct light averaged over a piece of surface: light of surfaces by exact form factors at grid points, with ever
//! finer grids until the average converges; light of lamps by clipping.

use crate::gather::Gather;
use crate::gather::receiver::receiver;
use crate::gather::surface_piece::{SurfacePiece, cells, centre};
use equilux_bake::geometry::aabb::Aabb;
use equilux_formats::{Element, Rgb};
use glam::DVec3;

/// Cells on each side of the successive grids.
const GRIDS: [usize; 4] = [1, 2, 4, 8];

/// Grids for reflected light, which has no sharp edges except at contacts.
const COARSE_GRIDS: &[usize] = &[2, 4];

/// A finer grid is used where the last step changed the average by more than this share. Midpoint rules have an error
/// of a third of their last change where light is smooth, and of less than that change at shadow edges.
const MAX_RELATIVE_CHANGE: f64 = 0.01;

impl Gather {
    /// The average direct irradiance of pieces, W/m². Accuracy is reduced for light far below `unit`, W/m².
    pub fn direct(&self, pieces: &[SurfacePiece], unit: Rgb) -> Vec<Rgb> {
        let mut found = self.glow_over(pieces, unit);
        for lamp in self.lamps() {
            let arriving = lamp.irradiance(self.world(), pieces);
            found.iter_mut().zip(arriving).for_each(|(sum, h)| *sum += h);
        }
        found
    }

    /// The average reflected irradiance of pieces, W/m²: from their centres where nothing is near, otherwise from
    /// grids as for direct light.
    pub fn reflected_over(&self, pieces: &[SurfacePiece], unit: Rgb) -> Vec<Rgb> {
        let reflected = |points: &[Element]| self.reflected(points);
        let all: Vec<usize> = (0..pieces.len()).collect();
        let mut found = averages(pieces, &all, 1, &reflected);
        let near: Vec<usize> = all.into_iter().filter(|&number| self.stands_near(&pieces[number])).collect();
        refine(pieces, &mut found, near, COARSE_GRIDS, unit, reflected);
        found
    }

    /// Whether any geometry lies in front of a piece within its own size.
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

/// Use ever finer grids for the pieces in `open` whose average has not converged.
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
            let stays = |c: usize| {
                (average[c] - before[c]).abs() <= MAX_RELATIVE_CHANGE * average[c].max(0.1 * unit[c])
            };
            if !(0..3).all(stays) {
                moves.push(number);
            }
        }
        open = moves;
    }
}

/// The averages of some pieces over grids.
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
            // A piece as small as the rounding of its corners gets the light at its centre.
            weights.push((place, if whole > 0.0 { area / whole } else { 1.0 / cells.len() as f64 }));
        }
    }
    let mut sums = vec![Rgb::BLACK; which.len()];
    for ((place, weight), light) in weights.into_iter().zip(light(&points)) {
        sums[place] += light * weight;
    }
    sums
}
