//! The texels of a chart, to be traced: their open areas, rows of sharp light for all of them, and rows of rays for those between
//! which light is interpolated.
//!
//! Rectangles of texels are divided until what would arrive from surfaces with made-up radiosities is predicted in the middle by
//! interpolation between the corners. So texels with rays follow from geometry alone, and are dense where the view changes.

use super::atlas::{Atlas, Tile};
use super::grid::MARGIN;
use super::squares::Square;
use super::texels::{Texel, Texels};
use crate::receivers::Receivers;
use crate::receivers::open_area::{OpenArea, PlanePiece};
use crate::receivers::sharp::SharpRows;
use equilux_bake::geometry::aabb::Aabb;
use equilux_bake::rays::areas::AreaRow;
use equilux_bake::rays::hemisphere::Emitters;
use equilux_bake::rays::sources::Effort;
use equilux_formats::Result;
use glam::{DAffine3, DVec3, dvec2};
use rayon::prelude::*;
use std::collections::BTreeMap;

/// Light is interpolated over at most this share of the harmonic mean distance that rays go (Ward & Heckbert 1992) at the corner
/// where it is largest,
const WIDEST: f64 = 0.25;

/// and in any case over this share where it is least.
const ALWAYS: f64 = 0.1;

/// Largest error of interpolation in the middle of a rectangle, with made-up radiosities between 0 and 1.
const MAX_ERROR: f64 = 0.004;

/// A rectangle is divided if anything stands above its inside within this share of its longer side.
const ABOVE: f64 = 0.5;

/// Texels on each side of a square of neighbours, for which it is found out together what stands between them and a source.
const BUNDLE: u32 = 8;

/// Texels are interpolated between sides whose normals have at least this cosine.
const FLAT: f64 = 0.999;

/// The texels of a chart.
pub struct TracedChart<'a> {
    receivers: &'a Receivers<'a>,
    atlas: &'a Atlas,
    tile: &'a Tile,
    texels: Texels,
    open: Vec<Option<OpenArea>>,
    /// The number of the texel at each place of the rectangle; u32::MAX if none of the chart is there or all is covered.
    number: Vec<u32>,
}

/// What the rays of a chart's texels end on, for all places of its rectangle.
pub struct TracedRays {
    /// The rows; those of texels that are interpolated, or not in the chart, have no rays.
    pub rows: Vec<AreaRow>,
    /// 0 where nothing of the chart is open, 1 where something is, and more for the lowest texel of a rectangle that is
    /// interpolated: see [`TracedRays::leaf_at`].
    pub marks: Vec<u8>,
}

impl TracedRays {
    /// The mark of a rectangle that is interpolated after so many divisions.
    pub fn leaf_at(depth: u8) -> u8 {
        depth + 2
    }
}

/// The lattice over the texels of a chart's rectangle, without its margin.
pub fn lattice(size: [u32; 2]) -> Vec<Square> {
    Square::lattice([MARGIN; 2], size.map(|side| side - MARGIN - 1))
}

/// The middle of a texel's square, in the plane of its first footprint.
fn middle(texels: &Texels, texel: &Texel) -> DVec3 {
    let [x, y] = texel.at.map(|x| f64::from(x) + 0.5);
    texels.patches[texel.footprints[0].patch].point(dvec2(x, y))
}

impl<'a> TracedChart<'a> {
    /// The chart of a tile. Fails if the monitor was stopped.
    pub fn new(receivers: &'a Receivers, atlas: &'a Atlas, tile: &'a Tile) -> Result<Self> {
        let (chart, grid) = atlas.chart_of(tile);
        let texels = Texels::new(chart, grid, 0..tile.size[1], tile.instance, DAffine3::IDENTITY);
        let open_area = |texel: &Texel| {
            let pieces = texel.footprints.iter().map(|piece| (piece.corners.as_slice(), piece.normal));
            let pieces: Vec<PlanePiece> = pieces.collect();
            OpenArea::of(receivers.scenery, tile.instance, &pieces, middle(&texels, texel))
        };
        let open: Vec<Option<OpenArea>> = texels.texels.par_iter().map(open_area).collect();
        receivers.check_stopped()?;
        let mut number = vec![u32::MAX; tile.texels()];
        for (k, (texel, open)) in texels.texels.iter().zip(&open).enumerate() {
            if open.is_some() {
                number[(texel.at[1] * tile.size[0] + texel.at[0]) as usize] = k as u32;
            }
        }
        Ok(Self { receivers, atlas, tile, texels, open, number })
    }

    fn place(&self, [x, y]: [u32; 2]) -> usize {
        (y * self.tile.size[0] + x) as usize
    }

    /// The number of the texel at a place, if it is open.
    fn at(&self, at: [u32; 2]) -> Option<usize> {
        let number = self.number[self.place(at)];
        (number != u32::MAX).then_some(number as usize)
    }

    fn area(&self, texel: usize) -> &Emitters {
        &self.open[texel].as_ref().expect("it is open").area
    }

    /// Rows of sharp light, for all places of the rectangle.
    pub fn sharp(&self) -> SharpRows {
        let Receivers { sharp, scenery, .. } = self.receivers;
        let instance = self.tile.instance;
        let all: Vec<usize> = (0..self.open.len()).filter(|&texel| self.open[texel].is_some()).collect();
        let among = sharp.in_view(scenery, instance, all.iter().map(|&texel| self.area(texel)));
        let mut bundles: BTreeMap<[u32; 2], Vec<usize>> = BTreeMap::new();
        for &texel in &all {
            bundles.entry(self.texels.texels[texel].at.map(|x| x / BUNDLE)).or_default().push(texel);
        }
        let bundles: Vec<Vec<usize>> = bundles.into_values().collect();
        let found: Vec<SharpRows> = bundles
            .par_iter()
            .map(|bundle| {
                let areas: Vec<&Emitters> = bundle.iter().map(|&texel| self.area(texel)).collect();
                sharp.rows(scenery, instance, (&areas, self.tile.chart as u32), &among, Effort::TEXELS)
            })
            .collect();
        let mut rows = vec![vec![]; self.number.len()];
        for (texel, row) in bundles.into_iter().flatten().zip(found.into_iter().flatten()) {
            rows[self.place(self.texels.texels[texel].at)] = row;
        }
        rows
    }

    /// Rows of rays. Fails if the monitor was stopped.
    pub fn rays(&self) -> Result<TracedRays> {
        let marks = self.number.iter().map(|&number| u8::from(number != u32::MAX)).collect();
        let mut traced = TracedRays { rows: vec![AreaRow::default(); self.number.len()], marks };
        let (mut squares, mut depth) = (lattice(self.tile.size), 0);
        while !squares.is_empty() {
            let regular: Vec<bool> = squares.par_iter().map(|square| self.is_regular(*square)).collect();
            let needs = |(square, regular): (&Square, &bool)| {
                (square.is_smallest() || *regular).then(|| square.corners())
            };
            self.trace(squares.iter().zip(&regular).filter_map(needs).flatten(), &mut traced.rows);
            let small = |square: &Square| self.spacings(*square, &traced.rows)[1] <= ALWAYS;
            let wide = |square: &Square| self.spacings(*square, &traced.rows)[0] > WIDEST;
            let (leaves, open): (Vec<Square>, Vec<Square>) = {
                let is_leaf = |(square, regular): &(Square, bool)| *regular && small(square);
                let (leaves, open): (Vec<_>, Vec<_>) = squares.into_iter().zip(regular).partition(is_leaf);
                let unsure = |(square, regular): &(Square, bool)| *regular && !wide(square);
                let (unsure, divided): (Vec<_>, Vec<_>) = open.into_iter().partition(unsure);
                let bare = |squares: Vec<(Square, bool)>| squares.into_iter().map(|(square, _)| square);
                let unsure: Vec<Square> = bare(unsure).collect();
                self.trace(unsure.iter().map(|square| square.centre()), &mut traced.rows);
                let (smooth, rough): (Vec<Square>, Vec<Square>) =
                    unsure.into_iter().partition(|square| self.error(*square, &traced.rows) <= MAX_ERROR);
                (bare(leaves).chain(smooth).collect(), bare(divided).chain(rough).collect())
            };
            leaves.iter().for_each(|leaf| traced.marks[self.place(leaf.low)] = TracedRays::leaf_at(depth));
            squares =
                open.into_iter().filter(|square| !square.is_smallest()).flat_map(Square::parts).collect();
            depth += 1;
            self.receivers.check_stopped()?;
        }
        Ok(traced)
    }

    /// Traces the open ones of these texels that have no rows yet.
    fn trace(&self, wanted: impl Iterator<Item = [u32; 2]>, rows: &mut [AreaRow]) {
        let mut wanted: Vec<[u32; 2]> =
            wanted.filter(|&at| self.at(at).is_some() && rows[self.place(at)].rays == 0).collect();
        wanted.sort_unstable();
        wanted.dedup();
        let traced: Vec<AreaRow> = wanted.par_iter().map(|&at| self.row(at)).collect();
        wanted.into_iter().zip(traced).for_each(|(at, row)| rows[self.place(at)] = row);
    }

    fn row(&self, at: [u32; 2]) -> AreaRow {
        let area = self.area(self.at(at).expect("it is open"));
        // Places as small as half a texel: each gets the mean over a texel.
        let least = self.atlas.texel_size / 2.0;
        self.receivers.row(self.tile.instance, (area, self.tile.chart as u32), least)
    }

    /// The longer side of a rectangle over the harmonic mean distance of rays, at the corners where this is least and most.
    fn spacings(&self, square: Square, rows: &[AreaRow]) -> [f64; 2] {
        let [a, b, c, _] = self.corners(square);
        let longer = (b - a).length().max((c - a).length());
        let near = square.corners().map(|at| longer * rows[self.place(at)].nearness);
        [near.into_iter().fold(f64::INFINITY, f64::min), near.into_iter().fold(0.0, f64::max)]
    }

    /// The error of interpolation in the middle of a rectangle, with made-up radiosities.
    fn error(&self, square: Square, rows: &[AreaRow]) -> f64 {
        let proxy = |at: [u32; 2]| self.receivers.proxy(&rows[self.place(at)]);
        let (corners, middle) = (square.corners().map(proxy), proxy(square.centre()));
        let predicted = |c: usize| square.interpolated(corners.map(|corner| corner[c]), square.centre());
        (0..3).map(|c| (predicted(c) - middle[c]).abs()).fold(0.0, f64::max)
    }

    /// Whether all texels of a rectangle are open and lie in one plane, and nothing is above its inside.
    fn is_regular(&self, square: Square) -> bool {
        let normal = |texel: usize| self.texels.texels[texel].footprints[0].normal;
        let Some(first) = self.at(square.low) else { return false };
        let is_flat = |at: [u32; 2]| {
            self.at(at).is_some_and(|texel| {
                let mut footprints = self.texels.texels[texel].footprints.iter();
                self.open[texel].as_ref().is_some_and(|open| open.is_whole)
                    && footprints.all(|footprint| footprint.normal.dot(normal(first)) >= FLAT)
            })
        };
        square.has_inside() && square.texels().all(is_flat) && !self.stands_above(square, normal(first))
    }

    fn stands_above(&self, square: Square, normal: DVec3) -> bool {
        let placement = self.receivers.placed.instances[self.tile.instance].placement;
        let corners = self.corners(square).map(|p| placement.transform_point3(p));
        let (middle, [a, b, c, _]) = (corners.iter().sum::<DVec3>() / 4.0, corners);
        let normal = placement.transform_vector3(normal).normalize();
        let longer = (b - a).length().max((c - a).length());
        let inside = corners.map(|corner| corner.lerp(middle, self.atlas.texel_size / longer));
        let above = inside.map(|corner| corner + normal * (ABOVE * longer));
        let bounds = Aabb::around(inside.into_iter().chain(above));
        let slack = 1e-6 * bounds.diagonal().max(middle.length());
        let before = |corner: &DVec3| normal.dot(*corner - middle) > slack;
        let world = &self.receivers.placed.world;
        world.occluders().any(|other| !other.meets(&bounds), |occluder| occluder.corners.iter().any(before))
    }

    /// The middles of a rectangle's corner texels, in coordinates of the instance; all are open.
    fn corners(&self, square: Square) -> [DVec3; 4] {
        square.corners().map(|at| middle(&self.texels, &self.texels.texels[self.at(at).expect("it is open")]))
    }
}
