//! The area of a piece of surface that nothing covers: a crate on a floor, or a floor around a sunk crate, hides the rest. Light
//! is averaged over what is left, so that texels are not dark for being half covered.

use super::area_of;
use super::curve::Curve;
use crate::gather::surface_piece::cells;
use equilux_bake::geometry::polygon::{Polygon, area};
use equilux_bake::rays::areas::Cover;
use equilux_bake::rays::hemisphere::Emitters;
use equilux_bake::rays::scenery::Scenery;
use glam::DVec3;

/// An open area.
#[derive(Debug)]
pub struct OpenArea {
    /// The area, in coordinates of the instance.
    pub area: Emitters,
    /// Whether nothing is covered.
    pub is_whole: bool,
}

/// A planar convex polygon.
#[derive(Debug, Clone, Copy)]
pub struct PlanePiece<'a> {
    /// Its corners.
    pub corners: &'a [DVec3],
    /// Its unit normal.
    pub normal: DVec3,
    /// The smooth surface for which it stands, if that is not flat.
    pub curve: Option<&'a Curve>,
}

/// Cells on each side of a polygon of which it is found out whether something covers them.
const CELLS: usize = 8;

/// A black back within so many widths of a piece covers it.
const NEAR: f64 = 4.0;

/// What stands in front of a piece within this share of its width covers it: no texel can show how light ends in such a gap.
const GAP: f64 = 0.125;

/// Where something is covered, light is taken from open cells that are no more than so many cells further from the middle of the
/// piece than the nearest one is.
const NEAREST: f64 = 2.0;

impl OpenArea {
    /// The open area of a piece of an instance, in its coordinates, around this middle; none if all of it is covered.
    pub fn of(scenery: &Scenery, instance: usize, polygons: &[PlanePiece], middle: DVec3) -> Option<Self> {
        let width = polygons.iter().map(|piece| area(piece.corners)).sum::<f64>().sqrt();
        let cover = Cover { scenery, instance, near: NEAR * width, gap: GAP * width };
        let may_be_covered = polygons.iter().any(|&PlanePiece { corners, normal, .. }| {
            let middle = raised(mean(corners), normal);
            places(corners, normal).any(|place| cover.may_be_covered(place, normal, middle))
        });
        if !may_be_covered {
            return Some(Self { area: area_of(polygons.iter().copied())?, is_whole: true });
        }
        let divided = polygons
            .iter()
            .flat_map(|piece| cells(piece.corners, CELLS).into_iter().map(move |cell| (cell, piece)));
        let all: Vec<(Polygon, &PlanePiece)> = divided.collect();
        let is_open = |(cell, PlanePiece { normal, .. }): &&(Polygon, &PlanePiece)| {
            !cover.is_covered(raised(mean(cell), *normal), *normal)
        };
        let open: Vec<&(Polygon, &PlanePiece)> = all.iter().filter(is_open).collect();
        let is_whole = open.len() == all.len();
        let distance = |cell: &[DVec3]| (mean(cell) - middle).length();
        let nearest = open.iter().map(|(cell, _)| distance(cell)).fold(f64::INFINITY, f64::min);
        let most = nearest + NEAREST * width / CELLS as f64;
        let used: Vec<_> = open.into_iter().filter(|(cell, _)| is_whole || distance(cell) <= most).collect();
        // Cells whose corners are open too, or all if there are none.
        let whole_cell = |(cell, PlanePiece { normal, .. }): &&&(Polygon, &PlanePiece)| {
            places(cell, *normal).all(|place| !cover.is_covered(place, *normal))
        };
        let clear: Vec<_> = if is_whole { vec![] } else { used.iter().filter(whole_cell).copied().collect() };
        let used = if clear.is_empty() { used } else { clear };
        let area = area_of(used.iter().map(|(corners, piece)| PlanePiece { corners, ..**piece }))?;
        Some(Self { area, is_whole })
    }
}

/// The middle of a polygon, and places near its corners, a little in front of it.
fn places(corners: &[DVec3], normal: DVec3) -> impl Iterator<Item = DVec3> {
    let middle = mean(corners);
    let near = corners.iter().map(move |corner| corner.lerp(middle, 1.0 / CELLS as f64));
    std::iter::once(middle).chain(near).map(move |place| raised(place, normal))
}

fn mean(corners: &[DVec3]) -> DVec3 {
    corners.iter().sum::<DVec3>() / corners.len() as f64
}

/// A place a little in front of its surface: corners are stored as f32.
fn raised(place: DVec3, normal: DVec3) -> DVec3 {
    place + normal * (1e-6 * place.abs().max_element())
}
