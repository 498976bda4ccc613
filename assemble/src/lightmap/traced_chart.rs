//! The texels of a chart, to be traced: their open areas, rows of sharp light for all of them, and rows of rays for those between
//! which light is interpolated.
//!
//! Rectangles of texels are divided until what would arrive from surfaces with made-up radiosities is predicted in the middle by
//! interpolation between the corners. So texels with rays follow from geometry alone, and are dense where the view changes.

use super::atlas::{Atlas, Tile};
use super::grid::MARGIN;
use super::knots::Knots;
use super::side::SurfaceSide;
use super::squares::Square;
use super::texels::{Texel, TexelFootprint, Texels};
use crate::receivers::Receivers;
use crate::receivers::curve::Curve;
use crate::receivers::open_area::{OpenArea, PlanePiece};
use crate::receivers::sharp::SharpRows;
use equilux_bake::geometry::aabb::Aabb;
use equilux_bake::geometry::polygon::{Polygon, part};
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

/// Largest error of interpolation in the middle of a rectangle of at least [`WIDE`] texels, with made-up radiosities between 0 and 1.
/// It is about the noise of the rows.
const MAX_ERROR: f64 = 0.006;

/// In a rectangle of fewer texels than this the error may be larger, in proportion: there, it is a shadow that is blurred by a
/// texel or two, and no square.
const WIDE: f64 = 4.0;

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
    /// How their light is found.
    pub marks: Vec<Mark>,
}

/// What is known of a texel: whether any of its area is open, whether all of it is, and, for the lowest texel of a rectangle that
/// is interpolated, after how many divisions of the lattice that is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Mark(pub u8);

impl Mark {
    /// Nothing of the chart is open.
    pub const NOTHING: Self = Self(0);
    const OPEN: Self = Self(1);
    const WHOLE: Self = Self(3);

    /// Whether it has light.
    pub fn is_open(self) -> bool {
        self.0 & 1 == 1
    }

    /// Whether nothing covers it, so that it can be interpolated.
    pub fn is_whole(self) -> bool {
        self.0 & 2 == 2
    }

    fn add_leaf(&mut self, depth: u8) {
        self.0 |= (depth + 1) << 2;
    }

    /// Whether it is the lowest of a rectangle that is interpolated after so many divisions.
    pub fn is_leaf(self, depth: u8) -> bool {
        self.0 >> 2 == depth + 1
    }
}

/// The lattice over the texels of a chart's rectangle, without its margin.
pub fn lattice(size: [u32; 2]) -> Vec<Square> {
    Square::lattice([MARGIN; 2], size.map(|side| side - MARGIN - 1))
}

/// The largest error of interpolation in the middle of a rectangle.
fn max_error(square: Square) -> f64 {
    let steps = square.steps().into_iter().max().unwrap_or(1);
    MAX_ERROR * (WIDE / f64::from(steps)).max(1.0)
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
        let mut texels = Texels::new(chart, grid, 0..tile.size[1], tile.instance, DAffine3::IDENTITY);
        let curves: Vec<Option<Curve>> = chart.sides.iter().map(SurfaceSide::curve).collect();
        let open_area = |texel: &Texel| {
            let pieces = texel.footprints.iter().map(|TexelFootprint { corners, normal, side, .. }| {
                PlanePiece { corners, normal: *normal, curve: curves[*side].as_ref() }
            });
            let pieces: Vec<PlanePiece> = pieces.collect();
            OpenArea::of(receivers.scenery, tile.instance, &pieces, middle(&texels, texel))
        };
        let open: Vec<Option<OpenArea>> = texels.texels.par_iter().map(open_area).collect();
        receivers.check_stopped()?;
        // From here on, normals are those of light.
        for footprint in texels.texels.iter_mut().flat_map(|texel| &mut texel.footprints) {
            if let Some(curve) = &curves[footprint.side] {
                let middle = footprint.corners.iter().sum::<DVec3>() / footprint.corners.len() as f64;
                footprint.normal = curve.at(middle).normal;
            }
        }
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
        let mark = |&number: &u32| {
            let open = self.open.get(number as usize).and_then(Option::as_ref);
            open.map_or(Mark::NOTHING, |open| if open.is_whole { Mark::WHOLE } else { Mark::OPEN })
        };
        let marks = self.number.iter().map(mark).collect();
        let mut traced = TracedRays { rows: vec![AreaRow::default(); self.number.len()], marks };
        let (mut squares, mut depth) = (lattice(self.tile.size), 0);
        while !squares.is_empty() {
            squares.retain(|square| square.texels().any(|at| self.at(at).is_some()));
            let knots: Vec<Option<Knots>> = squares.par_iter().map(|square| self.knots(*square)).collect();
            let (smallest, larger): (Vec<_>, Vec<_>) =
                squares.into_iter().zip(knots).partition(|(square, _)| square.is_smallest());
            self.trace(smallest.iter().flat_map(|(square, _)| square.texels()), &mut traced.rows);
            let own = larger.iter().filter_map(|(_, knots)| knots.as_ref());
            self.trace(own.flat_map(Knots::all).copied(), &mut traced.rows);
            let (mut leaves, mut unsure, mut divided) = (vec![], vec![], vec![]);
            for (square, knots) in larger {
                let Some(knots) = knots else {
                    divided.push(square);
                    continue;
                };
                let [least, most] = self.spacings(square, &knots, &traced.rows);
                if most <= ALWAYS {
                    leaves.push(square);
                } else if least > WIDEST {
                    divided.push(square);
                } else {
                    unsure.push((square, self.middle_of(square, &knots), knots));
                }
            }
            self.trace(unsure.iter().map(|(_, middle, _)| *middle), &mut traced.rows);
            for (square, middle, knots) in unsure {
                let is_smooth = self.error(&knots, middle, &traced.rows) <= max_error(square);
                if is_smooth { leaves.push(square) } else { divided.push(square) }
            }
            let is_part = |at: &[u32; 2]| !traced.marks[self.place(*at)].is_whole();
            let parts: Vec<[u32; 2]> = leaves.iter().flat_map(|leaf| leaf.texels()).filter(is_part).collect();
            self.trace(parts.into_iter(), &mut traced.rows);
            leaves.iter().for_each(|leaf| traced.marks[self.place(leaf.low)].add_leaf(depth));
            squares = divided.into_iter().flat_map(Square::parts).collect();
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
        let least = self.atlas.texel_size_of(self.tile) / 2.0;
        self.receivers.row(self.tile.instance, (area, self.tile.chart as u32), least)
    }

    /// The longer side of a rectangle over the harmonic mean distance of rays, at the knots where this is least and most.
    fn spacings(&self, square: Square, knots: &Knots, rows: &[AreaRow]) -> [f64; 2] {
        let texel = self.texel(knots.all()[0]);
        let patch = &self.texels.patches[texel.footprints[0].patch];
        let [across, down] = square.steps().map(f64::from);
        let longer = (across * patch.du.length()).max(down * patch.dv.length());
        let near = knots.all().iter().map(|&at| longer * rows[self.place(at)].nearness);
        near.fold([f64::INFINITY, 0.0], |[least, most], near| [least.min(near), most.max(near)])
    }

    /// The texel that can be interpolated nearest to the middle of a rectangle's polygon.
    fn middle_of(&self, square: Square, knots: &Knots) -> [u32; 2] {
        let middle = knots.middle();
        let off = |&[x, y]: &[u32; 2]| dvec2(f64::from(x), f64::from(y)).distance_squared(middle);
        let inner = square.texels().filter(|&at| self.is_whole(at));
        inner.min_by(|a, b| off(a).total_cmp(&off(b))).expect("knots are such texels")
    }

    /// The error of interpolation at a texel, with made-up radiosities.
    fn error(&self, knots: &Knots, at: [u32; 2], rows: &[AreaRow]) -> f64 {
        let proxy = |at: [u32; 2]| self.receivers.proxy(&rows[self.place(at)]);
        let (known, own) = (knots.all().iter().map(|&knot| proxy(knot)), proxy(at));
        let mut off = own;
        for (known, weight) in known.zip(knots.weights(at)) {
            (0..3).for_each(|c| off[c] -= known[c] * weight);
        }
        off.into_iter().map(f64::abs).fold(0.0, f64::max)
    }

    fn texel(&self, at: [u32; 2]) -> &Texel {
        &self.texels.texels[self.at(at).expect("it is open")]
    }

    fn is_whole(&self, at: [u32; 2]) -> bool {
        self.at(at).is_some_and(|texel| self.open[texel].as_ref().is_some_and(|open| open.is_whole))
    }

    /// The texels between which a rectangle may be interpolated; none if its texels do not lie in one plane, or something is above
    /// its inside.
    fn knots(&self, square: Square) -> Option<Knots> {
        let knots = Knots::of(square, |at| self.is_whole(at))?;
        let normal = self.texel(knots.all()[0]).footprints[0].normal;
        let is_flat = |at: [u32; 2]| {
            let footprints = self.at(at).map(|texel| &self.texels.texels[texel].footprints);
            footprints.into_iter().flatten().all(|footprint| footprint.normal.dot(normal) >= FLAT)
        };
        (square.texels().all(is_flat) && !self.stands_above(&knots, normal)).then_some(knots)
    }

    fn stands_above(&self, knots: &Knots, normal: DVec3) -> bool {
        let placement = self.receivers.placed.instances[self.tile.instance].placement;
        let normal = placement.transform_vector3(normal).normalize();
        let corners = knots.all().iter().map(|&at| middle(&self.texels, self.texel(at)));
        let corners: Vec<DVec3> = corners.map(|corner| placement.transform_point3(corner)).collect();
        let middle = corners.iter().sum::<DVec3>() / corners.len() as f64;
        let width = corners.iter().map(|corner| (*corner - middle).length()).fold(0.0, f64::max);
        if width <= self.atlas.texel_size_of(self.tile) {
            return false;
        }
        let inside =
            corners.iter().map(|corner| corner.lerp(middle, self.atlas.texel_size_of(self.tile) / width));
        let inside: Vec<DVec3> = inside.collect();
        let above = inside.iter().map(|corner| *corner + normal * (ABOVE * width));
        let bounds = Aabb::around(inside.iter().copied().chain(above));
        let slack = 1e-5 * bounds.diagonal().max(middle.length());
        let height = |p: DVec3| normal.dot(p - middle) - slack;
        let rises = |corners: &[DVec3]| {
            let sides = (0..6).map(|side| (side / 2, if side % 2 == 0 { 1.0 } else { -1.0 }));
            let inside = |rest: Option<Polygon>, (axis, sign): (usize, f64)| {
                let bound = if sign > 0.0 { bounds.low[axis] } else { bounds.high[axis] };
                let [inside, _] = part(&rest?, |p| sign * (p[axis] - bound));
                inside
            };
            let [high, _] = part(corners, height);
            sides.fold(high.filter(|high| high.iter().any(|&p| height(p) > 0.0)), inside).is_some()
        };
        let world = &self.receivers.placed.world;
        world.occluders().any(|other| !other.meets(&bounds), |occluder| rises(&occluder.corners))
    }
}
