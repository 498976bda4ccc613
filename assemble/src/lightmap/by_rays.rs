//! The light of texels where rows of the scene are counted rays.
//!
//! Light with sharp shadows has form factors from each texel. All other light arrives along the rays of some texels, and is
//! interpolated between them ([`super::traced_chart`]); where they are follows from geometry alone. Both kinds of rows are kept, for some charts of an instance together: other
//! lights, colours and textures cost products.

use super::atlas::{Atlas, Tile};
use super::knots::Knots;
use super::squares::Square;
use super::traced_chart::{Mark, TracedChart, TracedRays, lattice};
use crate::receivers::Receivers;
use equilux_bake::oven::cached::cached;
use equilux_bake::oven::placed_keys::{PLACE_LIGHT, TEXEL_LAYOUT, TEXEL_LIGHT, TEXEL_RAYS, texel_block};
use equilux_formats::fingerprint::{Content, Digest, Manifest};
use equilux_formats::rows::{CountedRow, Precision, RowGroup};
use equilux_formats::{Result, Rgb, Rows};
use rayon::prelude::*;
use std::cell::OnceCell;
use std::collections::HashMap;
use std::ops::Range;

/// Rays of a texel that gets any.
pub const RAYS: u32 = 512;

/// Charts are kept together up to this many texels.
const GROUP_TEXELS: usize = 1 << 16;

/// For each tile the irradiance of its texels, W/m²; none for those without light: outside of the chart, or covered with all
/// of the chart. Fails if the monitor was stopped meanwhile.
pub fn irradiance(receivers: &Receivers, atlas: &Atlas) -> Result<Vec<Vec<Option<Rgb>>>> {
    let tiles = atlas.tiles();
    let monitor = receivers.coupler.monitor;
    monitor.begin("lightmap", tiles.len(), super::ROWS_PER_TEXEL * texels_of(&tiles) as f64);
    let mut light = Vec::with_capacity(tiles.len());
    for (number, range) in groups(&tiles) {
        let group = Group { receivers, atlas, tiles: &tiles[range.clone()], number };
        light.extend(group.irradiance()?);
        monitor.advance(range.len());
    }
    Ok(light)
}

fn texels_of(tiles: &[Tile]) -> usize {
    tiles.iter().map(Tile::texels).sum()
}

/// Ranges of tiles that are kept together, numbered by instance.
fn groups(tiles: &[Tile]) -> Vec<(usize, Range<usize>)> {
    let mut groups: Vec<(usize, Range<usize>)> = vec![];
    for (place, tile) in tiles.iter().enumerate() {
        match groups.last_mut() {
            Some((_, range)) if tiles[range.start].instance == tile.instance => {
                if texels_of(&tiles[range.start..=place]) <= GROUP_TEXELS {
                    range.end = place + 1;
                } else {
                    let number = groups[groups.len() - 1].0 + 1;
                    groups.push((number, place..place + 1));
                }
            }
            _ => groups.push((0, place..place + 1)),
        }
    }
    groups
}

/// Some charts of an instance.
struct Group<'a> {
    receivers: &'a Receivers<'a>,
    atlas: &'a Atlas,
    tiles: &'a [Tile],
    /// Their number in the instance.
    number: usize,
}

impl Group<'_> {
    fn instance(&self) -> usize {
        self.tiles[0].instance
    }

    fn irradiance(&self) -> Result<Vec<Vec<Option<Rgb>>>> {
        let Receivers { columns, sharp, .. } = self.receivers;
        let charts = OnceCell::new();
        let charts = || -> Result<&Vec<TracedChart>> {
            if charts.get().is_none() {
                let _ =
                    charts.set(self.each_tile(|tile| TracedChart::new(self.receivers, self.atlas, tile))?);
            }
            Ok(charts.get().expect("just made"))
        };
        let traced = OnceCell::new();
        let traced = || -> Result<&Vec<TracedRays>> {
            if traced.get().is_none() {
                let mut charts = charts()?.iter();
                let _ = traced.set(self.each_tile(|_| charts.next().expect("one for each tile").rays())?);
            }
            Ok(traced.get().expect("just made"))
        };
        let with_rays =
            |what: &str| self.manifest(what).setting("rays of a texel", self.receivers.samples.rays());
        let rays = self.kept(TEXEL_RAYS, with_rays(TEXEL_RAYS), || {
            let rows = traced()?.iter().flat_map(|tile| &tile.rows);
            let rows = rows.map(|row| CountedRow { counts: row.counts.clone(), rays: row.rays });
            Ok(Rows::from_counts(columns.count(), rows))
        })?;
        let layout = self.kept(TEXEL_LAYOUT, with_rays(TEXEL_LAYOUT), || {
            let marks = traced()?.iter().flat_map(|tile| &tile.marks);
            let row = |&Mark(bits): &Mark| if bits == 0 { vec![] } else { vec![(0, f64::from(bits))] };
            Ok(block(1, marks.map(row)))
        })?;
        let lights = sharp.strengths.len();
        let with_lights = |manifest: Manifest| manifest.digest("lights", sharp.digest());
        let light = self.kept(TEXEL_LIGHT, with_lights(self.manifest(TEXEL_LIGHT)), || {
            let mut charts = charts()?.iter();
            let rows = self.each_tile(|_| Ok(charts.next().expect("one for each tile").sharp()))?;
            Ok(block(lights, rows.into_iter().flatten()))
        })?;
        let places = self.receivers.places_of(&rays);
        let on_places = self.kept(PLACE_LIGHT, with_lights(with_rays(PLACE_LIGHT)), || {
            Ok(block(lights, self.receivers.sharp_on_places(&places).into_iter()))
        })?;
        let sent = self.receivers.sent_by_places(&places, &on_places);
        let kept = KeptRows { rays, layout, light };
        let starts = self.tiles.iter().scan(0, |end, tile| {
            *end += tile.texels();
            Some(*end - tile.texels())
        });
        let tiles: Vec<(&Tile, usize)> = self.tiles.iter().zip(starts).collect();
        Ok(tiles.into_par_iter().map(|(tile, start)| self.lit(tile, start, &kept, &sent)).collect())
    }

    /// What `of` makes of each tile. Fails if the monitor was stopped.
    fn each_tile<'b, T>(&'b self, mut of: impl FnMut(&'b Tile) -> Result<T>) -> Result<Vec<T>> {
        let of = |tile: &'b Tile| {
            let made = of(tile)?;
            self.receivers.check_stopped()?;
            Ok(made)
        };
        self.tiles.iter().map(of).collect()
    }

    fn kept(&self, what: &str, manifest: Manifest, make: impl FnOnce() -> Result<Rows>) -> Result<Rows> {
        let coupler = &self.receivers.coupler;
        let name = coupler.name(self.instance(), &texel_block(what, self.number));
        Ok(cached(coupler.store, &name, &manifest, coupler.monitor, make)?.0)
    }

    /// What all blocks depend on: the scene's geometry and the texels.
    fn manifest(&self, what: &str) -> Manifest {
        self.receivers.coupler.manifest(self.instance(), what).digest("texels", self.digest())
    }

    fn digest(&self) -> Digest {
        let mut content = Content::new();
        for tile in self.tiles {
            let (chart, grid) = self.atlas.chart_of(tile);
            let planes: Vec<u32> = chart.planes.iter().map(|&plane| plane as u32).collect();
            content =
                content.bytes([tile.chart as u32, tile.size[0], tile.size[1]].map(u32::to_le_bytes).concat());
            // Rays that are shorter than a texel see places as large as half of one.
            content = content.f64s(&[self.atlas.texel_size_of(tile)]);
            content = content.bytes(planes.into_iter().flat_map(u32::to_le_bytes).collect::<Vec<u8>>());
            for side in &chart.sides {
                let corners = side.corners.as_slice().iter().flat_map(|corner| corner.to_array());
                content = content.f64s(&corners.collect::<Vec<f64>>());
                let normals = side.normals.into_iter().flatten().flat_map(|normal| normal.to_array());
                content = content.f64s(&normals.collect::<Vec<f64>>());
            }
            for patch in grid.patches() {
                let vectors = [patch.origin, patch.du, patch.dv, patch.normal];
                content = content.f64s(&vectors.map(|vector| vector.to_array()).concat());
            }
        }
        content.digest()
    }

    /// The light of a tile whose texels have the rows from `start` on.
    fn lit(
        &self,
        tile: &Tile,
        start: usize,
        KeptRows { rays, layout, light }: &KeptRows,
        places: &HashMap<u32, Rgb>,
    ) -> Vec<Option<Rgb>> {
        let number = |[x, y]: [u32; 2]| (y * tile.size[0] + x) as usize;
        let mark = |texel| Mark(layout.row(start + texel).map(|(_, bits)| bits as u8).sum());
        let marks: Vec<Mark> = (0..tile.texels()).map(mark).collect();
        let mut along: Vec<Option<Rgb>> = vec![None; tile.texels()];
        let fill = |at, along: &mut Vec<Option<Rgb>>| {
            let texel = number(at);
            if marks[texel].is_open() && along[texel].is_none() {
                along[texel] = Some(self.receivers.along(tile.instance, rays, start + texel, places));
            }
            along[texel].unwrap_or_default()
        };
        let (mut squares, mut depth) = (lattice(tile.size), 0);
        // From large to small: what lies on the edge of a larger one is interpolated there.
        while !squares.is_empty() {
            let is_leaf = |square: &Square| marks[number(square.low)].is_leaf(depth);
            let (leaves, divided): (Vec<Square>, Vec<Square>) = squares.into_iter().partition(is_leaf);
            let (smallest, divided): (Vec<Square>, Vec<Square>) =
                divided.into_iter().partition(|square| square.is_smallest());
            for leaf in leaves {
                let is_inner = |at| marks[number(at)].is_whole();
                let Some(knots) = Knots::of(leaf, is_inner) else { continue };
                let known: Vec<Rgb> = knots.all().iter().map(|&at| fill(at, &mut along)).collect();
                for at in leaf.texels() {
                    if !is_inner(at) {
                        fill(at, &mut along);
                    } else if along[number(at)].is_none() {
                        let weights = knots.weights(at);
                        let sum = known.iter().zip(weights).fold(Rgb::BLACK, |sum, (&h, w)| sum + h * w);
                        along[number(at)] = Some(sum);
                    }
                }
            }
            smallest.iter().flat_map(|square| square.texels()).for_each(|at| {
                fill(at, &mut along);
            });
            squares = divided.into_iter().flat_map(Square::parts).collect();
            depth += 1;
        }
        let light = along.into_iter().enumerate().map(|(texel, along)| {
            along.map(|along| along + self.receivers.strength_of(light, start + texel))
        });
        light.collect()
    }
}

/// Blocks of some charts.
struct KeptRows {
    /// What rays of texels end on.
    rays: Rows,
    /// Marks of texels: see [`Mark`].
    layout: Rows,
    /// Form factors to lights with sharp shadows.
    light: Rows,
}

/// A block of these rows.
fn block(columns: usize, rows: impl Iterator<Item = Vec<(u32, f64)>>) -> Rows {
    let group = |row: Vec<(u32, f64)>| {
        let (columns, values) = row.into_iter().unzip();
        RowGroup { columns, values, receivers: 1 }
    };
    Rows::from_groups(columns, rows.map(group), Precision::Single)
}
