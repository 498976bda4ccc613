//! Seams: where two charts meet in one smooth surface, lookups on both sides of the edge must agree.
//!
//! Along every such edge, points are taken at the distance of the coarser chart's texels, so that they ask no more than
//! its texels can give. With c_k the difference of the two bilinear lookups at point k as a row over texels, and v the
//! values they had, the correction y minimises |y|² + μ Σ_(i, j) (y_i − y_j)² + λ Σ_k (c_k·(v + y))² over pairs of texels
//! beside each other: as small and even as agreement allows, and whatever detail v has stays. Least squares over seams are
//! due to Iwanicki (SIGGRAPH 2013, "Lighting Technology of The Last of Us"). The system is solved by conjugate gradients.

use super::atlas::{Atlas, Tile};
use super::contacts::{Contact, smooth_contacts};
use super::side::Side;
use super::texels::bilinear;
use equilux_formats::{Instance, Rgb};
use glam::{DAffine3, DVec3};
use std::collections::BTreeMap;

/// λ: a jump shrinks to about a thousandth.
const STIFFNESS: f64 = 1e3;
/// μ: a correction fades along the seam over about three texels.
const EVENNESS: f64 = 10.0;
/// Conjugate gradients end when the residual has shrunk by this factor; half floats keep 5e-4.
const ENOUGH: f64 = 1e-7;
/// More steps than a system of this stiffness ever needs.
const MOST_STEPS: usize = 1000;

/// The difference of two lookups: texels of all charts by number, with weights.
type Difference = Vec<(usize, f64)>;

/// Make charts of `tiles` agree along their seams. `values`: for each tile one a texel of its rectangle, row after row.
pub fn close_seams(atlas: &Atlas, instances: &[Instance], tiles: &[Tile], values: &mut [Vec<Rgb>]) {
    let starts: Vec<usize> = tiles
        .iter()
        .scan(0, |next, tile| {
            let start = *next;
            *next += (tile.size[0] * tile.size[1]) as usize;
            Some(start)
        })
        .collect();
    let differences = differences(atlas, instances, tiles, &starts);
    // Only texels at seams take part, numbered without gaps.
    let numbers: BTreeMap<usize, usize> =
        differences.iter().flatten().map(|&(texel, _)| (texel, 0)).collect();
    let texels: Vec<usize> = numbers.into_keys().collect();
    let number = |texel: usize| texels.binary_search(&texel);
    let places: Vec<(usize, usize)> = texels
        .iter()
        .map(|&texel| {
            let tile = starts.partition_point(|&start| start <= texel) - 1;
            (tile, texel - starts[tile])
        })
        .collect();
    let inner = |&(texel, weight): &(usize, f64)| (number(texel).expect("it was put there"), weight);
    let rows: Vec<Difference> = differences.iter().map(|row| row.iter().map(inner).collect()).collect();
    let beside = |(i, &(tile, place)): (usize, &(usize, usize))| {
        let width = tiles[tile].size[0] as usize;
        let right = ((place + 1) % width != 0).then_some(texels[i] + 1);
        let below = (place + width < values[tile].len()).then_some(texels[i] + width);
        [right, below].into_iter().flatten().filter_map(move |texel| Some([i, number(texel).ok()?])).collect()
    };
    let pairs: Vec<[usize; 2]> = places.iter().enumerate().flat_map::<Vec<_>, _>(beside).collect();
    let corrections: [Vec<f64>; 3] = std::array::from_fn(|channel| {
        let had: Vec<f64> = places.iter().map(|&(tile, texel)| values[tile][texel][channel]).collect();
        correction(&rows, &pairs, &had)
    });
    for (i, &(tile, texel)) in places.iter().enumerate() {
        let value = &mut values[tile][texel];
        // A fit may swing below zero next to a shadow; light does not.
        *value = [0, 1, 2].map(|channel: usize| (value[channel] + corrections[channel][i]).max(0.0));
    }
}

/// The lookups that must agree, in the scene.
fn differences(atlas: &Atlas, instances: &[Instance], tiles: &[Tile], starts: &[usize]) -> Vec<Difference> {
    let (mut sides, mut whose) = (Vec::new(), Vec::new());
    for (number, tile) in tiles.iter().enumerate() {
        let placement = instances[tile.instance].placement;
        let (chart, _) = atlas.chart_of(tile);
        sides.extend(chart.sides.iter().map(|side| Side::of(&side.surface().placed(placement))));
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

/// (I + μDᵀD + λCᵀC) y = −λCᵀC v by conjugate gradients.
fn correction(rows: &[Difference], pairs: &[[usize; 2]], v: &[f64]) -> Vec<f64> {
    let add_agreement = |x: &[f64], y: &mut [f64]| {
        for row in rows {
            let difference: f64 = row.iter().map(|&(i, weight)| weight * x[i]).sum();
            row.iter().for_each(|&(i, weight)| y[i] += STIFFNESS * difference * weight);
        }
    };
    let apply = |x: &[f64]| {
        let mut y = x.to_vec();
        for &[i, j] in pairs {
            let force = EVENNESS * (x[i] - x[j]);
            y[i] += force;
            y[j] -= force;
        }
        add_agreement(x, &mut y);
        y
    };
    let mut y = vec![0.0; v.len()];
    let mut residual = vec![0.0; v.len()];
    add_agreement(v, &mut residual);
    residual.iter_mut().for_each(|r| *r = -*r);
    let mut direction = residual.clone();
    let mut square = dot(&residual, &residual);
    let goal = square * ENOUGH * ENOUGH;
    for _ in 0..MOST_STEPS {
        if square <= goal {
            break;
        }
        let image = apply(&direction);
        let step = square / dot(&direction, &image);
        add(&mut y, step, &direction);
        add(&mut residual, -step, &image);
        let next = dot(&residual, &residual);
        let turned = residual.iter().zip(&direction).map(|(r, d)| r + next / square * d).collect();
        (direction, square) = (turned, next);
    }
    y
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

fn add(to: &mut [f64], factor: f64, other: &[f64]) {
    to.iter_mut().zip(other).for_each(|(to, other)| *to += factor * other);
}
