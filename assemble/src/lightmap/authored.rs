//! The author's own lightmap layout (TEXCOORD_1). In goes a part; out come its charts with the maps that lay them out,
//! if the layout is one that light can be kept in.
//!
//! Sides are of one chart where they touch both on the part and in the layout. Backs of double-sided surfaces have a
//! sheet of their own, laid out like the fronts.

use super::bands::bands;
use super::chart::Chart;
use super::contacts::opposed_contacts;
use super::grid::{Grid, MARGIN};
use super::overlap::any_overlap;
use super::pack::Spot;
use super::patch::Map;
use super::side::{SurfaceSide, sides};
use super::texels::Texels;
use equilux_bake::geometry::disjoint_sets::DisjointSets;
use equilux_formats::{Corners, Part};
use glam::{DAffine3, DVec2, DVec3};

/// How far places may be off, in widths of the layout: a tenth of a texel of 4096, or a step of 16-bit coordinates and a
/// half.
const STEP: f64 = 2.5e-5;
/// A layout whose charts are too near each other for the texels asked for gets more of them, up to so many times in each
/// direction.
const FINER: [f64; 3] = [1.0, 2.0, 4.0];

/// A layout whose image has so many times the texels that its surfaces need is not kept: a single surface that is laid
/// out far too small can ask for any number.
const SPARSE: f64 = 16.0;

/// A part's charts in its author's layout.
#[derive(Debug, Clone)]
pub struct AuthoredLayout {
    /// The charts, fronts first.
    pub charts: Vec<Chart>,
    /// For each chart the maps of its planes to the layout, whose width and height are 1.
    maps: Vec<Vec<Map>>,
    /// How many charts are fronts.
    fronts: usize,
    /// The longest piece of surface that the layout's width covers, metres.
    pub stretch: f64,
}

/// Charts on sheets.
#[derive(Debug)]
pub struct Sheets {
    /// The grid of each chart.
    pub grids: Vec<Grid>,
    /// Where each chart lies.
    pub spots: Vec<Spot>,
    /// The sizes of the sheets, texels; the layout lies within a margin.
    pub sheets: Vec<[u32; 2]>,
}

impl AuthoredLayout {
    /// The layout of `part`, nothing if it has none, or why it cannot be kept.
    pub fn of(part: &Part) -> Option<Result<Self, &'static str>> {
        part.surfaces.iter().any(|surface| surface.lightmap.is_some()).then(|| Self::read(part))
    }

    fn read(part: &Part) -> Result<Self, &'static str> {
        let sides = sides(part);
        let (fronts, backs) = sides.split_at(part.surfaces.len());
        let places: Vec<&[DVec2]> =
            fronts.iter().map(places).collect::<Option<_>>().ok_or("is not on all surfaces")?;
        if places
            .iter()
            .copied()
            .flatten()
            .any(|place| place.min_element() < -STEP || place.max_element() > 1.0 + STEP)
        {
            return Err("reaches outside 0 to 1");
        }
        if any_overlap(places.iter().map(|places| flat(places)), DVec3::Z) {
            return Err("lays surfaces over each other");
        }
        let mut authored = Self { charts: vec![], maps: vec![], fronts: 0, stretch: 0.0 };
        for sides in [fronts, backs] {
            authored.fronts = authored.charts.len();
            for members in groups(sides) {
                authored
                    .add(members.into_iter().map(|side| sides[side]).collect())
                    .ok_or("gives a surface no area")?;
            }
        }
        let area: f64 = sides.iter().map(|side| side.area).sum();
        if authored.stretch.powi(2) * authored.sheets() as f64 > SPARSE * area {
            return Err("fills too little of its image");
        }
        Ok(authored)
    }

    /// Add a chart of these sides.
    fn add(&mut self, sides: Vec<SurfaceSide>) -> Option<()> {
        let (mut maps, mut planes): (Vec<Map>, Vec<usize>) = (vec![], vec![]);
        for side in &sides {
            let (corners, places) = (side.corners.as_slice(), places(side)?);
            let last = corners.len() - 1;
            let own = [0, 1, last];
            let map = Map::through(own.map(|i| corners[i]), own.map(|i| places[i]), side.normal)?;
            let fits = |known: &Map| {
                let back = |(place, corner): (&DVec2, &DVec3)| {
                    (known.patch.point(*place) - corner).length() <= STEP * known.patch.stretch()
                };
                places.iter().zip(corners).all(back) && known.patch.normal.dot(side.normal) > 0.0
            };
            planes.push(maps.iter().position(fits).unwrap_or_else(|| {
                maps.push(map);
                maps.len() - 1
            }));
            self.stretch = self.stretch.max(map.patch.stretch());
        }
        self.charts.push(Chart { direction: sides[0].normal, material: sides[0].material, sides, planes });
        self.maps.push(maps);
        Some(())
    }

    /// How many sheets there are.
    pub fn sheets(&self) -> usize {
        if self.fronts == 0 || self.fronts == self.charts.len() { 1 } else { 2 }
    }

    /// The layout with texels of at most `texel` metres on sheets of at most `limit` texels a side, or why that cannot be.
    pub fn lay_out(&self, texel: f64, limit: u32) -> Result<Sheets, &'static str> {
        let least = (self.stretch / texel).ceil().max(1.0);
        for finer in FINER {
            let count = least * finer;
            if count + f64::from(2 * MARGIN) > f64::from(limit) {
                return Err("is too small for these texels");
            }
            let sheets = self.sheets_of(count as u32);
            if !self.share_texels(&sheets) {
                return Ok(sheets);
            }
        }
        Err("has charts too near each other")
    }

    fn sheets_of(&self, count: u32) -> Sheets {
        let grid = |maps: &Vec<Map>, chart: &Chart| {
            let all =
                || chart.sides.iter().filter_map(places).flatten().map(|place| place * f64::from(count));
            // Margins included, as the sheet has the same ones.
            let low = all().fold(DVec2::INFINITY, DVec2::min).floor().max(DVec2::ZERO).as_uvec2();
            let high =
                all().fold(DVec2::ZERO, DVec2::max).ceil().min(DVec2::splat(f64::from(count))).as_uvec2();
            let size = (high - low + 2 * MARGIN).to_array();
            let first = DVec2::splat(f64::from(MARGIN)) - low.as_dvec2();
            let maps = maps.iter().map(|map| map.scaled(f64::from(count), first)).collect();
            (Grid::of_maps(size, maps), low.to_array())
        };
        let (grids, lows): (Vec<Grid>, Vec<[u32; 2]>) =
            self.maps.iter().zip(&self.charts).map(|(maps, chart)| grid(maps, chart)).unzip();
        let on_second = |chart: usize| self.sheets() == 2 && chart >= self.fronts;
        let spots = lows.into_iter().enumerate();
        Sheets {
            grids,
            spots: spots.map(|(chart, at)| Spot { image: usize::from(on_second(chart)), at }).collect(),
            sheets: vec![[count + 2 * MARGIN; 2]; self.sheets()],
        }
    }

    /// Whether lookups of two charts use the same texel: those with some of the chart in them, and their neighbours.
    fn share_texels(&self, sheets: &Sheets) -> bool {
        let width = sheets.sheets[0][0] as usize;
        let mut owners = vec![0; width * width * sheets.sheets.len()];
        self.charts.iter().zip(&sheets.grids).zip(&sheets.spots).zip(1..).any(
            |(((chart, grid), spot), number)| {
                let texels = bands(grid.size)
                    .flat_map(|rows| Texels::new(chart, grid, rows, 0, DAffine3::IDENTITY).texels);
                let mut ring = texels.flat_map(|texel| {
                    let [x, y] = [0, 1].map(|i| (spot.at[i] + texel.at[i]) as usize);
                    (0..9).map(move |k| (spot.image * width + y + k / 3 - 1) * width + x + k % 3 - 1)
                });
                ring.any(|texel| {
                    let before = std::mem::replace(&mut owners[texel], number);
                    before != 0 && before != number
                })
            },
        )
    }
}

fn places(side: &SurfaceSide) -> Option<&[DVec2]> {
    Some(&side.lightmap.as_ref()?[..side.corners.as_slice().len()])
}

/// Places as a polygon in the plane z = 0, counter-clockwise however they lie.
fn flat(places: &[DVec2]) -> Corners {
    let point = |place: &DVec2| place.extend(0.0);
    let corners = match places {
        [a, b, c] => Corners::triangle([a, b, c].map(point)),
        [a, b, c, d] => Corners::quad([a, b, c, d].map(point)),
        _ => unreachable!("a side has three or four corners"),
    };
    if corners.double_area_vector().z < 0.0 { corners.flipped() } else { corners }
}

/// Sides in groups that touch each other both on the part and in the layout, and are of one material.
fn groups(sides: &[SurfaceSide]) -> Vec<Vec<usize>> {
    let mut sets = DisjointSets::new(sides.len());
    for contact in opposed_contacts(sides) {
        let [a, b] = contact.sides;
        let together = contact.ends.iter().all(|&end| {
            let [p, q] = [a, b].map(|side| place_on(&sides[side], end));
            p.zip(q).is_some_and(|(p, q)| (p - q).abs().max_element() <= STEP)
        });
        if together && sides[a].material == sides[b].material {
            sets.join(a, b);
        }
    }
    sets.into_sets()
}

/// Where a point on a side's outline lies in the layout.
fn place_on(side: &SurfaceSide, point: DVec3) -> Option<DVec2> {
    let (corners, places) = (side.corners.as_slice(), places(side)?);
    let own = [0, 1, corners.len() - 1];
    let map = Map::through(own.map(|i| corners[i]), own.map(|i| places[i]), side.normal)?;
    Some(map.texel_of(point))
}
