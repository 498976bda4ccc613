//! The author's lightmap layout (TEXCOORD_1). Input: a part. Output: its charts and the maps that lay them out, if
//! the layout is suitable for light.
//!
//! Sides belong to the same chart where they touch both on the part and in the layout. Backs of double-sided surfaces
//! get a sheet of their own with the layout of the fronts.

use super::bands::bands;
use super::chart::Chart;
use super::contacts::opposed_contacts;
use super::grid::{Grid, MARGIN};
use super::overlap::any_overlap;
use super::pack::Spot;
use super::patch::Map;
use super::side::{SurfaceSide, are_alike, sides};
use super::texels::Texels;
use equilux_bake::geometry::disjoint_sets::DisjointSets;
use equilux_formats::{Corners, Part};
use glam::{DAffine3, DVec2, DVec3};

/// Tolerance of positions, as a share of the layout's width: a tenth of a texel of 4096, or one and a half steps of
/// 16-bit coordinates.
const POSITION_TOLERANCE: f64 = 2.5e-5;
/// Factors by which the texel count in each direction is increased if charts are too close to each other.
const REFINEMENTS: [f64; 3] = [1.0, 2.0, 4.0];

/// A layout is rejected if its image needs more than this many times the texels of its surfaces: a single surface
/// that is far too small in the layout could require any number of texels.
const MAX_WASTE: f64 = 16.0;

/// A part's charts in its author's layout.
#[derive(Debug, Clone)]
pub struct AuthoredLayout {
    /// The charts, fronts first.
    pub charts: Vec<Chart>,
    /// For each chart, the maps from its planes to the layout, which is the unit square.
    maps: Vec<Vec<Map>>,
    /// Number of charts that are fronts.
    fronts: usize,
    /// The longest distance on a surface that the layout's width covers, metres.
    pub stretch: f64,
}

/// Charts on sheets.
#[derive(Debug)]
pub struct Sheets {
    /// The grid of each chart.
    pub grids: Vec<Grid>,
    /// The position of each chart.
    pub spots: Vec<Spot>,
    /// The sizes of the sheets, texels; the layout lies within a margin.
    pub sheets: Vec<[u32; 2]>,
}

impl AuthoredLayout {
    /// The author's layout of `part`: none if there is none, or the reason why it cannot be used.
    pub fn of(part: &Part) -> Option<Result<Self, &'static str>> {
        part.surfaces.iter().any(|surface| surface.lightmap.is_some()).then(|| Self::read(part))
    }

    fn read(part: &Part) -> Result<Self, &'static str> {
        let sides = sides(part);
        let (fronts, backs) = sides.split_at(part.surfaces.len());
        let places: Vec<&[DVec2]> =
            fronts.iter().map(places).collect::<Option<_>>().ok_or("is not on all surfaces")?;
        if places.iter().copied().flatten().any(|place| {
            place.min_element() < -POSITION_TOLERANCE || place.max_element() > 1.0 + POSITION_TOLERANCE
        }) {
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
        if authored.stretch.powi(2) * authored.sheets() as f64 > MAX_WASTE * area {
            return Err("fills too little of its image");
        }
        Ok(authored)
    }

    /// Add a chart of these sides. None if a side has no area in the layout.
    fn add(&mut self, sides: Vec<SurfaceSide>) -> Option<()> {
        let (mut maps, mut planes): (Vec<Map>, Vec<usize>) = (vec![], vec![]);
        for side in &sides {
            let (corners, places) = (side.corners.as_slice(), places(side)?);
            let last = corners.len() - 1;
            let own = [0, 1, last];
            let map = Map::through(own.map(|i| corners[i]), own.map(|i| places[i]), side.normal)?;
            let fits = |known: &Map| {
                let back = |(place, corner): (&DVec2, &DVec3)| {
                    (known.patch.point(*place) - corner).length()
                        <= POSITION_TOLERANCE * known.patch.stretch()
                };
                places.iter().zip(corners).all(back) && known.patch.normal.dot(side.normal) > 0.0
            };
            planes.push(maps.iter().position(fits).unwrap_or_else(|| {
                maps.push(map);
                maps.len() - 1
            }));
            self.stretch = self.stretch.max(map.patch.stretch());
        }
        let SurfaceSide { normal: direction, material, texels, .. } = sides[0];
        self.charts.push(Chart { direction, material, texels, sides, planes });
        self.maps.push(maps);
        Some(())
    }

    /// Number of sheets.
    pub fn sheets(&self) -> usize {
        if self.fronts == 0 || self.fronts == self.charts.len() { 1 } else { 2 }
    }

    /// The layout with texels of at most `texel` metres on sheets of at most `limit` texels on each side, or the
    /// reason why that is impossible.
    pub fn lay_out(&self, texel: f64, limit: u32) -> Result<Sheets, &'static str> {
        let least = (self.stretch / texel).ceil().max(1.0);
        for finer in REFINEMENTS {
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
            // Includes margins, since the sheet has the same ones.
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

    /// Whether bilinear lookups of two charts use the same texel: texels with part of a chart, and their neighbours.
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

/// Layout positions as a polygon in the plane z = 0, always counter-clockwise.
fn flat(places: &[DVec2]) -> Corners {
    let point = |place: &DVec2| place.extend(0.0);
    let corners = match places {
        [a, b, c] => Corners::triangle([a, b, c].map(point)),
        [a, b, c, d] => Corners::quad([a, b, c, d].map(point)),
        _ => unreachable!("a side has three or four corners"),
    };
    if corners.double_area_vector().z < 0.0 { corners.flipped() } else { corners }
}

/// Groups of sides of one material and one choice of texels that touch each other both on the part and in the layout.
fn groups(sides: &[SurfaceSide]) -> Vec<Vec<usize>> {
    let mut sets = DisjointSets::new(sides.len());
    for contact in opposed_contacts(sides) {
        let [a, b] = contact.sides;
        let together = contact.ends.iter().all(|&end| {
            let [p, q] = [a, b].map(|side| place_on(&sides[side], end));
            p.zip(q).is_some_and(|(p, q)| (p - q).abs().max_element() <= POSITION_TOLERANCE)
        });
        if together && are_alike(&sides[a], &sides[b]) {
            sets.join(a, b);
        }
    }
    sets.into_sets()
}

/// The position in the layout of a point on a side's outline.
fn place_on(side: &SurfaceSide, point: DVec3) -> Option<DVec2> {
    let (corners, places) = (side.corners.as_slice(), places(side)?);
    let own = [0, 1, corners.len() - 1];
    let map = Map::through(own.map(|i| corners[i]), own.map(|i| places[i]), side.normal)?;
    Some(map.texel_of(point))
}
