//! Seams: where two charts meet in one smooth surface, lookups on both sides of the edge must agree. Input: the
//! charts of all instances with their light. Output: corrected light.
//!
//! Along each such edge, points are spaced by the texels of the coarser chart, since closer points would demand more
//! than its texels can represent. Least squares over seams are due to Iwanicki (SIGGRAPH 2013, "Lighting Technology
//! of The Last of Us").

use super::atlas::{Atlas, Tile};
use super::contacts::{Contact, smooth_contacts};
use super::least_squares::{DifferenceRow, correction};
use super::side::SurfaceSide;
use super::texels::bilinear;
use equilux_formats::{Instance, Rgb};
use glam::{DAffine3, DVec3};
use std::collections::BTreeSet;

/// Make the charts of `tiles` agree along their seams. `values`: for each tile one value for each texel of its
/// rectangle, row after row.
pub fn close_seams(atlas: &Atlas, instances: &[Instance], tiles: &[Tile], values: &mut [Vec<Rgb>]) {
    let starts = starts(tiles);
    let mut differences = differences(atlas, instances, tiles, &starts);
    // Only texels at seams take part, renumbered without gaps.
    let texels: BTreeSet<usize> = differences.iter().flatten().map(|&(texel, _)| texel).collect();
    let texels: Vec<usize> = texels.into_iter().collect();
    let number = |texel: usize| texels.binary_search(&texel).ok();
    for (texel, _) in differences.iter_mut().flatten() {
        *texel = number(*texel).expect("it was put there");
    }
    let place = |&texel: &usize| {
        let tile = starts.partition_point(|&start| start <= texel) - 1;
        (tile, texel - starts[tile])
    };
    let places: Vec<(usize, usize)> = texels.iter().map(place).collect();
    let pairs: Vec<[usize; 2]> = (0..texels.len())
        .flat_map(|i| beside(&tiles[places[i].0], places[i].1).map(move |steps| (i, steps)))
        .filter_map(|(i, steps)| Some([i, number(texels[i] + steps)?]))
        .collect();
    let corrections: [Vec<f64>; 3] = std::array::from_fn(|channel| {
        let had: Vec<f64> = places.iter().map(|&(tile, texel)| values[tile][texel][channel]).collect();
        correction(&differences, &pairs, &had)
    });
    for (i, &(tile, texel)) in places.iter().enumerate() {
        let value = &mut values[tile][texel];
        // The fit may become negative next to a shadow; light cannot.
        *value = Rgb::from_fn(|channel| (value[channel] + corrections[channel][i]).max(0.0));
    }
}

/// The number of each tile's first texel, counting all tiles.
fn starts(tiles: &[Tile]) -> Vec<usize> {
    let next = |next: &mut usize, tile: &Tile| Some(std::mem::replace(next, *next + tile.texels()));
    tiles.iter().scan(0, next).collect()
}

/// Index offsets to the texels on the right and below, where they exist in the tile.
fn beside(tile: &Tile, texel: usize) -> impl Iterator<Item = usize> + use<> {
    let width = tile.size[0] as usize;
    let right = (!(texel + 1).is_multiple_of(width)).then_some(1);
    let below = (texel + width < tile.texels()).then_some(width);
    right.into_iter().chain(below)
}

/// The differences of lookups that must vanish, for all seams of the scene.
fn differences(
    atlas: &Atlas,
    instances: &[Instance],
    tiles: &[Tile],
    starts: &[usize],
) -> Vec<DifferenceRow> {
    let (mut sides, mut whose) = (Vec::new(), Vec::new());
    for (number, tile) in tiles.iter().enumerate() {
        let placement = instances[tile.instance].placement;
        let (chart, _) = atlas.chart_of(tile);
        sides.extend(chart.sides.iter().map(|side| SurfaceSide::of(&side.surface().placed(placement))));
        whose.extend(chart.planes.iter().map(|&plane| (number, plane)));
    }
    let seams = smooth_contacts(&sides).into_iter().filter_map(|contact: Contact| {
        let [a, b] = contact.sides.map(|side| whose[side]);
        (a.0 != b.0).then_some(([a, b], contact.ends))
    });
    let into_part: Vec<DAffine3> = instances.iter().map(|instance| instance.placement.inverse()).collect();
    let texel = |(tile, plane): (usize, usize), point: DVec3| {
        let own = into_part[tiles[tile].instance].transform_point3(point);
        atlas.chart_of(&tiles[tile]).1.texel_of(plane, own)
    };
    let lookup = |side: (usize, usize), point: DVec3, sign: f64| {
        let weighted = bilinear(texel(side, point), tiles[side.0].size[0]);
        weighted.map(|(texel, weight)| (starts[side.0] + texel, sign * weight))
    };
    let mut differences = Vec::new();
    for ([a, b], ends) in seams {
        let along = |side| (texel(side, ends[1]) - texel(side, ends[0])).length();
        let steps = along(a).min(along(b)).round().max(1.0) as usize;
        for step in 0..=steps {
            let point = ends[0] + (ends[1] - ends[0]) * (step as f64 / steps as f64);
            let both = [lookup(a, point, 1.0), lookup(b, point, -1.0)].concat();
            differences.push(both.into_iter().filter(|&(_, weight)| weight != 0.0).collect());
        }
    }
    differences
}
