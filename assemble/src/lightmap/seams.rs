//! Seams: where two charts meet in one smooth surface, with one normal, lookups on both sides of the edge must agree. Input: the
//! charts of all instances with their light. Output: corrected light.
//!
//! Texels change the less, the more of them lies in their chart: those in it have the light that they should, those in its margin
//! serve lookups alone.
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
use glam::{DAffine3, DVec2, DVec3, dvec2};
use std::collections::{BTreeSet, HashMap};

/// Cosine of the angle between normals that are the same: two degrees, twice the rounding of normals in files.
const SAME_NORMAL: f64 = 0.9994;

/// Make the charts of `tiles` agree along their seams. `values`: for each tile one value for each texel of its
/// rectangle, row after row. `distances`: how many texels each is away from where it was computed.
pub fn close_seams(
    atlas: &Atlas,
    instances: &[Instance],
    tiles: &[Tile],
    distances: &[Vec<u32>],
    values: &mut [Vec<Rgb>],
) {
    let starts = starts(tiles);
    let (mut differences, at_seam) = differences(atlas, instances, tiles, &starts);
    // Only texels at seams take part, renumbered without gaps.
    let texels: BTreeSet<usize> = differences.iter().flatten().map(|&(texel, _)| texel).collect();
    let texels: Vec<usize> = texels.into_iter().collect();
    let at_seam: Vec<SeamTexel> = texels.iter().map(|texel| at_seam[texel]).collect();
    let freedom: Vec<f64> = at_seam.iter().map(SeamTexel::freedom).collect();
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
        correction(&differences, &pairs, &freedom, &had)
    });
    let jumps = largest_jumps(&differences, |i| values[places[i].0][places[i].1], places.len());
    for (i, &(tile, texel)) in places.iter().enumerate() {
        let value = &mut values[tile][texel];
        // The fit may overshoot, or become negative next to a shadow; light cannot.
        *value = Rgb::from_fn(|channel| {
            let keeps = at_seam[i].is_curved && distances[tile][texel] == 0;
            let least = if keeps { MOST_CURVED * value[channel] } else { f64::INFINITY };
            let most = jumps[i][channel].min(least);
            (value[channel] + corrections[channel][i].clamp(-most, most)).max(0.0)
        });
    }
}

/// For each texel the largest difference of lookups that it takes part in. `value`: its light.
fn largest_jumps(differences: &[DifferenceRow], value: impl Fn(usize) -> Rgb, texels: usize) -> Vec<Rgb> {
    let mut jumps = vec![Rgb::BLACK; texels];
    for row in differences {
        let jump = row.iter().fold(Rgb::BLACK, |sum, &(i, weight)| sum + value(i) * weight);
        for &(i, _) in row {
            jumps[i] = Rgb::from_fn(|channel| jumps[i][channel].max(jump[channel].abs()));
        }
    }
    jumps
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

/// On curved surfaces, the light that was computed for a texel changes by at most this share of it. Light turns with the surface, so
/// where texels are coarse the difference of lookups is one of interpolation, not an error of the texels.
const MOST_CURVED: f64 = 0.025;

/// A texel that lookups at seams use.
#[derive(Debug, Clone, Copy)]
struct SeamTexel {
    /// About the share of it that lies in its chart.
    share: f64,
    /// Whether the surface at one of the seams is curved.
    is_curved: bool,
}

impl SeamTexel {
    /// How freely its light may change.
    fn freedom(&self) -> f64 {
        // All of it up to a half, as where a chart ends in the middles of its texels.
        (2.0 - 2.0 * self.share).min(1.0).powi(4).max(0.01)
    }

    /// The same texel at two seams.
    fn and(self, other: Self) -> Self {
        Self { share: self.share.min(other.share), is_curved: self.is_curved || other.is_curved }
    }
}

/// About the share of a texel that lies on the chart's side of an edge. All in texels; `inside`: a point on that side.
fn share_inside(texel: DVec2, [from, to]: [DVec2; 2], inside: DVec2) -> f64 {
    let across = (to - from).perp().normalize_or_zero();
    let height = |point: DVec2| (point - from).dot(across);
    (0.5 + height(texel) * height(inside).signum()).clamp(0.0, 1.0)
}

/// The sides of all instances in scene coordinates, and the tile and plane of each. Those without texels have no seams, but may
/// separate the light on others.
fn placed_sides(
    atlas: &Atlas,
    instances: &[Instance],
    tiles: &[Tile],
) -> (Vec<SurfaceSide>, Vec<Option<(usize, usize)>>) {
    let (mut sides, mut whose) = (Vec::new(), Vec::new());
    for (number, tile) in tiles.iter().enumerate() {
        let placement = instances[tile.instance].placement;
        let (chart, _) = atlas.chart_of(tile);
        sides.extend(chart.sides.iter().map(|side| SurfaceSide::of(&side.surface().placed(placement))));
        whose.extend(chart.planes.iter().map(|&plane| Some((number, plane))));
    }
    for (number, instance) in instances.iter().enumerate() {
        let own = &atlas.layout_of(number).without_texels;
        sides.extend(own.iter().map(|side| SurfaceSide::of(&side.surface().placed(instance.placement))));
    }
    whose.resize(sides.len(), None);
    (sides, whose)
}

/// The differences of lookups that must vanish, for all seams of the scene, and their texels.
fn differences(
    atlas: &Atlas,
    instances: &[Instance],
    tiles: &[Tile],
    starts: &[usize],
) -> (Vec<DifferenceRow>, HashMap<usize, SeamTexel>) {
    let (sides, whose) = placed_sides(atlas, instances, tiles);
    let seams = smooth_contacts(&sides).into_iter().filter_map(|contact: Contact| {
        let [a, b] = [whose[contact.sides[0]]?, whose[contact.sides[1]]?];
        let [first, second] = contact.sides.map(|side| contact.ends.map(|end| sides[side].normal_at(end)));
        let alike = (0..2).all(|end| first[end].dot(second[end]) >= SAME_NORMAL);
        let middles = contact.sides.map(|side| {
            let corners = sides[side].corners;
            corners.as_slice().iter().sum::<DVec3>() / corners.as_slice().len() as f64
        });
        let is_curved = contact.sides.iter().any(|&side| sides[side].normals.is_some());
        (alike && a.0 != b.0).then_some(([(a, middles[0]), (b, middles[1])], contact.ends, is_curved))
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
    let (mut differences, mut at_seam) = (Vec::new(), HashMap::new());
    for ([(a, middle_a), (b, middle_b)], ends, is_curved) in seams {
        let edges = [(a, middle_a), (b, middle_b)]
            .map(|(side, middle)| (side.0, ends.map(|end| texel(side, end)), texel(side, middle)));
        let along = |side| (texel(side, ends[1]) - texel(side, ends[0])).length();
        let steps = along(a).min(along(b)).round().max(1.0) as usize;
        for step in 0..=steps {
            let point = ends[0] + (ends[1] - ends[0]) * (step as f64 / steps as f64);
            let both = [lookup(a, point, 1.0), lookup(b, point, -1.0)];
            for ((tile, edge, inside), own) in edges.iter().zip(&both) {
                for &(number, _) in own {
                    let (width, own) = (tiles[*tile].size[0] as usize, number - starts[*tile]);
                    let middle = dvec2((own % width) as f64 + 0.5, (own / width) as f64 + 0.5);
                    let share = share_inside(middle, *edge, *inside);
                    let here = SeamTexel { share, is_curved };
                    at_seam
                        .entry(number)
                        .and_modify(|known: &mut SeamTexel| *known = known.and(here))
                        .or_insert(here);
                }
            }
            let both = both.concat();
            differences.push(both.into_iter().filter(|&(_, weight)| weight != 0.0).collect());
        }
    }
    (differences, at_seam)
}
