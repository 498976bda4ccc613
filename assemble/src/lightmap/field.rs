//! Interpolates values of a chart's texels that mostly change slowly. Input: texels, and a function that computes the
//! values of some of them. Output: values of all texels, computed where they change or where geometry is near, and
//! interpolated elsewhere.
//!
//! Squares of texels are subdivided until interpolation between their corners predicts the value in their middle.
//! Compare Ward & Heckbert 1992, who space samples by the distance of nearby geometry.

use super::texels::{Texel, Texels};
use crate::gather::Gather;
use equilux_bake::geometry::aabb::Aabb;
use equilux_formats::Rgb;
use std::collections::HashMap;

/// Initial side of squares, texels.
const INITIAL_SIDE: u32 = 16;

/// The values of all texels, computed by `sample` for some of them and interpolated for the others. `smooth` decides
/// whether a square can be interpolated, from the values at its corners, the interpolated value in its middle, and
/// the computed value there.
pub fn interpolated(
    gather: &Gather,
    texels: &Texels,
    sample: impl Fn(&[&Texel]) -> Vec<Rgb>,
    smooth: impl Fn([Rgb; 4], Rgb, Rgb) -> bool,
) -> Vec<Rgb> {
    let number: HashMap<[u32; 2], usize> =
        texels.texels.iter().enumerate().map(|(n, texel)| (texel.at, n)).collect();
    let mut field = TexelField { gather, texels, sample, smooth, number, known: HashMap::new() };
    let mut found = vec![None; texels.texels.len()];
    let mut open = field.squares();
    while !open.is_empty() {
        field.compute(&open);
        let mut halves = Vec::new();
        for square in open {
            match field.settled(square) {
                Some(texels) => texels.into_iter().for_each(|(number, h)| found[number] = Some(h)),
                None => halves.extend(square.quarters()),
            }
        }
        open = halves;
    }
    found.into_iter().map(|h| h.expect("every texel lies in a square")).collect()
}

/// A square of texels to be determined: its lowest texel, and its side.
#[derive(Clone, Copy)]
struct Square {
    at: [u32; 2],
    size: u32,
}

/// The known values of a chart's texels.
struct TexelField<'a, S, T> {
    gather: &'a Gather,
    texels: &'a Texels,
    sample: S,
    smooth: T,
    number: HashMap<[u32; 2], usize>,
    known: HashMap<usize, Rgb>,
}

impl<S: Fn(&[&Texel]) -> Vec<Rgb>, T: Fn([Rgb; 4], Rgb, Rgb) -> bool> TexelField<'_, S, T> {
    /// Squares that cover all texels.
    fn squares(&self) -> Vec<Square> {
        let mut corners: Vec<[u32; 2]> = self
            .texels
            .texels
            .iter()
            .map(|texel| texel.at.map(|x| x / INITIAL_SIDE * INITIAL_SIDE))
            .collect();
        corners.sort_unstable();
        corners.dedup();
        corners.into_iter().map(|at| Square { at, size: INITIAL_SIDE }).collect()
    }

    /// Compute the unknown values that these squares need, with neighbours in sequence.
    fn compute(&mut self, squares: &[Square]) {
        let mut wanted: Vec<usize> = squares.iter().flat_map(|square| self.needed(*square)).collect();
        wanted.retain(|number| !self.known.contains_key(number));
        wanted.sort_by_key(|&number| interleaved(self.texels.texels[number].at));
        wanted.dedup();
        let texels: Vec<&Texel> = wanted.iter().map(|&number| &self.texels.texels[number]).collect();
        let light = (self.sample)(&texels);
        self.known.extend(wanted.into_iter().zip(light));
    }

    /// The texels whose values a square needs: none if it will be subdivided in any case, all of a small one.
    fn needed(&self, square: Square) -> Vec<usize> {
        if square.size <= 2 {
            return self.inside(square).collect();
        }
        if !self.may_be_smooth(square) {
            return vec![];
        }
        square.probes().iter().map(|at| self.number[at]).collect()
    }

    /// The values of all texels of a square, if they can be interpolated or are known.
    fn settled(&self, square: Square) -> Option<Vec<(usize, Rgb)>> {
        if square.size <= 2 {
            return Some(self.inside(square).map(|number| (number, self.known[&number])).collect());
        }
        if !self.may_be_smooth(square) {
            return None;
        }
        let [corners @ .., middle] = square.probes().map(|at| self.known[&self.number[&at]]);
        let interpolated_value = |at: [u32; 2]| bilinear(corners, square.share_of(at));
        let centre = square.probes()[4];
        let smooth = (self.smooth)(corners, interpolated_value(centre), middle);
        smooth.then(|| {
            self.inside(square)
                .map(|number| (number, interpolated_value(self.texels.texels[number].at)))
                .collect()
        })
    }

    fn inside(&self, square: Square) -> impl Iterator<Item = usize> + '_ {
        let cells = (0..square.size)
            .flat_map(move |y| (0..square.size).map(move |x| [square.at[0] + x, square.at[1] + y]));
        cells.filter_map(|at| self.number.get(&at).copied())
    }

    /// Whether all texels of a square exist and lie in one plane, and no geometry is near it.
    fn may_be_smooth(&self, square: Square) -> bool {
        let patch_of = |number: usize| self.texels.texels[number].footprints[0].patch;
        let [first, last] = [0, square.size - 1].map(|k| self.number.get(&square.at.map(|x| x + k)));
        let (Some(&first), Some(_)) = (first, last) else { return false };
        let in_plane = |number: &usize| {
            self.texels.texels[*number].footprints.iter().all(|footprint| footprint.patch == patch_of(first))
        };
        if self.inside(square).filter(in_plane).count() != (square.size * square.size) as usize {
            return false;
        }
        let patch = &self.texels.patches[patch_of(first)];
        let [low, high] = [square.at, square.at.map(|x| x + square.size)].map(|at| at.map(f64::from));
        let corners = [[low[0], low[1]], [high[0], low[1]], [high[0], high[1]], [low[0], high[1]]];
        let corners = corners.map(|[x, y]| patch.point(glam::dvec2(x, y)));
        let reach = (corners[2] - corners[0]).length() / 4.0;
        !self.gather.anything_before(Aabb::around(corners).grown(reach), corners[0], patch.normal)
    }
}

impl Square {
    /// Its corner texels and its middle texel.
    fn probes(self) -> [[u32; 2]; 5] {
        let ([x, y], last) = (self.at, self.size - 1);
        [[x, y], [x + last, y], [x, y + last], [x + last, y + last], [x + self.size / 2, y + self.size / 2]]
    }

    /// The position of a texel between the corners, 0..1 along each side.
    fn share_of(self, at: [u32; 2]) -> [f64; 2] {
        [0, 1].map(|axis| f64::from(at[axis] - self.at[axis]) / f64::from(self.size - 1))
    }

    fn quarters(self) -> [Self; 4] {
        let size = self.size / 2;
        [[0, 0], [size, 0], [0, size], [size, size]]
            .map(|[x, y]| Self { at: [self.at[0] + x, self.at[1] + y], size })
    }
}

fn bilinear(corners: [Rgb; 4], [s, t]: [f64; 2]) -> Rgb {
    let weights = [(1.0 - s) * (1.0 - t), s * (1.0 - t), (1.0 - s) * t, s * t];
    corners.iter().zip(weights).fold(Rgb::BLACK, |sum, (corner, weight)| sum + *corner * weight)
}

/// The bits of both coordinates, interleaved (Morton 1966): a curve that keeps neighbours close.
fn interleaved([x, y]: [u32; 2]) -> u64 {
    let spread = |n: u32| (0..32).fold(0u64, |bits, k| bits | u64::from(n >> k & 1) << (2 * k));
    spread(x) | spread(y) << 1
}
