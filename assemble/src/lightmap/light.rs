//! The light of texels. In go texels with their footprints and a scene in equilibrium; out comes the irradiance of each.
//!
//! Direct light is averaged over the footprint. Reflected light is gathered at the middles of texels, of all where it
//! changes or where something stands near, else of a few: squares of texels are halved until what their corners say of
//! their middle is what is gathered there (compare Ward & Heckbert 1992, who space samples by what stands near).

use super::texels::{Piece, Texel, Texels};
use crate::gather::faces::Plane;
use crate::gather::{Gather, average};
use equilux_bake::equilibrium::added;
use equilux_formats::Rgb;
use glam::DVec3;
use std::collections::HashMap;

/// Squares begin with so many texels a side.
const SQUARE: u32 = 16;

/// What a square's corners say of its middle may be off by this share of what is there, or of a tenth of the mean light.
const OFF: f64 = 0.01;

/// Gives texels their light.
pub struct TexelLight<'a> {
    gather: &'a Gather,
    /// The scene's mean irradiance, W/m².
    mean: Rgb,
}

/// A square of texels whose light is to be found: its lowest texel, and how many a side.
#[derive(Clone, Copy)]
struct Square {
    at: [u32; 2],
    size: u32,
}

impl<'a> TexelLight<'a> {
    /// Light from `gather`; `mean` is the scene's mean irradiance, W/m².
    pub fn new(gather: &'a Gather, mean: Rgb) -> Self {
        Self { gather, mean }
    }

    /// One irradiance a texel, W/m².
    pub fn irradiance(&self, texels: &Texels) -> Vec<Rgb> {
        let faces = self.gather.faces();
        let planes: Vec<Plane> =
            texels.patches.iter().map(|patch| faces.in_plane(patch.origin, patch.normal)).collect();
        let direct = self.direct(texels, &planes);
        let reflected = self.reflected(texels, &planes);
        direct.into_iter().zip(reflected).map(|(a, b)| added(a, b)).collect()
    }

    fn direct(&self, texels: &Texels, planes: &[Plane]) -> Vec<Rgb> {
        let all: Vec<&Texel> = texels.texels.iter().collect();
        means(&all, planes, |pieces| self.gather.direct(pieces, self.mean))
    }

    fn reflected(&self, texels: &Texels, planes: &[Plane]) -> Vec<Rgb> {
        let number: HashMap<[u32; 2], usize> =
            texels.texels.iter().enumerate().map(|(n, texel)| (texel.at, n)).collect();
        let mut field = Field { light: self, texels, planes, number, known: HashMap::new() };
        let mut found = vec![None; texels.texels.len()];
        let mut open = field.squares();
        while !open.is_empty() {
            field.learn(&open);
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

    /// The reflected light of some texels.
    fn reflected_of(&self, texels: &[&Texel], planes: &[Plane]) -> Vec<Rgb> {
        means(texels, planes, |pieces| self.gather.reflected_over(pieces, self.mean))
    }

    fn is_near(&self, a: Rgb, b: Rgb) -> bool {
        (0..3).all(|c| (a[c] - b[c]).abs() <= OFF * b[c].max(0.1 * self.mean[c]))
    }
}

/// The mean light of each texel's pieces.
fn means(texels: &[&Texel], planes: &[Plane], light: impl Fn(&[average::Piece]) -> Vec<Rgb>) -> Vec<Rgb> {
    let pieces: Vec<average::Piece> = texels
        .iter()
        .flat_map(|texel| &texel.pieces)
        .map(|own| {
            let Piece { patch, corners, normal, area } = own;
            average::Piece { corners, normal: *normal, area: *area, plane: &planes[*patch] }
        })
        .collect();
    let mut light = light(&pieces).into_iter();
    let mean = |texel: &&Texel| {
        let sum = texel.pieces.iter().fold([0.0; 3], |sum, piece| {
            let h = light.next().expect("a value a piece");
            added(sum, h.map(|h| h * piece.area))
        });
        sum.map(|sum| sum / texel.area())
    };
    texels.iter().map(mean).collect()
}

/// Reflected light on one chart as far as it is known.
struct Field<'a> {
    light: &'a TexelLight<'a>,
    texels: &'a Texels,
    planes: &'a [Plane<'a>],
    number: HashMap<[u32; 2], usize>,
    known: HashMap<usize, Rgb>,
}

impl Field<'_> {
    /// Squares that cover all texels.
    fn squares(&self) -> Vec<Square> {
        let mut corners: Vec<[u32; 2]> =
            self.texels.texels.iter().map(|texel| texel.at.map(|x| x / SQUARE * SQUARE)).collect();
        corners.sort_unstable();
        corners.dedup();
        corners.into_iter().map(|at| Square { at, size: SQUARE }).collect()
    }

    /// Gather what these squares ask for and is not known, neighbours together.
    fn learn(&mut self, squares: &[Square]) {
        let mut wanted: Vec<usize> = squares.iter().flat_map(|square| self.asks(*square)).collect();
        wanted.retain(|number| !self.known.contains_key(number));
        wanted.sort_by_key(|&number| interleaved(self.texels.texels[number].at));
        wanted.dedup();
        let texels: Vec<&Texel> = wanted.iter().map(|&number| &self.texels.texels[number]).collect();
        let light = self.light.reflected_of(&texels, self.planes);
        self.known.extend(wanted.into_iter().zip(light));
    }

    /// The texels to be gathered for a square: none if it is to be halved whatever they say, all of a small one.
    fn asks(&self, square: Square) -> Vec<usize> {
        if square.size <= 2 {
            return self.inside(square).collect();
        }
        if !self.may_be_smooth(square) {
            return vec![];
        }
        square.probes().iter().map(|at| self.number[at]).collect()
    }

    /// The light of all texels of a square, if what is known is enough.
    fn settled(&self, square: Square) -> Option<Vec<(usize, Rgb)>> {
        if square.size <= 2 {
            return Some(self.inside(square).map(|number| (number, self.known[&number])).collect());
        }
        if !self.may_be_smooth(square) {
            return None;
        }
        let [corners @ .., middle] = square.probes().map(|at| self.known[&self.number[&at]]);
        let told = |at: [u32; 2]| bilinear(corners, square.share_of(at));
        let centre = square.probes()[4];
        let smooth = self.light.is_near(told(centre), middle)
            && corners
                .iter()
                .all(|&corner| (0..3).all(|c| corner[c] <= 2.0 * middle[c] && middle[c] <= 2.0 * corner[c]));
        smooth.then(|| {
            self.inside(square).map(|number| (number, told(self.texels.texels[number].at))).collect()
        })
    }

    fn inside(&self, square: Square) -> impl Iterator<Item = usize> + '_ {
        let cells = (0..square.size)
            .flat_map(move |y| (0..square.size).map(move |x| [square.at[0] + x, square.at[1] + y]));
        cells.filter_map(|at| self.number.get(&at).copied())
    }

    /// Whether all texels of a square are whole and in one plane, and nothing stands near it.
    fn may_be_smooth(&self, square: Square) -> bool {
        let [x, y] = square.at;
        let whole = |number: usize| {
            let texel = &self.texels.texels[number];
            texel.pieces.len() == 1
                && texel.pieces[0].patch == self.texels.texels[self.number_at(square)].pieces[0].patch
        };
        let last = square.size - 1;
        if self.number.get(&[x, y]).is_none() || self.number.get(&[x + last, y + last]).is_none() {
            return false;
        }
        let all: Vec<usize> = self.inside(square).collect();
        if all.len() != (square.size * square.size) as usize || !all.iter().all(|&number| whole(number)) {
            return false;
        }
        let patch = &self.texels.patches[self.texels.texels[all[0]].pieces[0].patch];
        let [low, high] = [square.at, square.at.map(|x| x + square.size)].map(|at| at.map(f64::from));
        let corners = [[low[0], low[1]], [high[0], low[1]], [high[0], high[1]], [low[0], high[1]]];
        let corners = corners.map(|[x, y]| patch.point(glam::dvec2(x, y)));
        let reach = (corners[2] - corners[0]).length() / 4.0;
        let box_low = corners.iter().copied().fold(DVec3::INFINITY, DVec3::min) - reach;
        let box_high = corners.iter().copied().fold(DVec3::NEG_INFINITY, DVec3::max) + reach;
        !self.light.gather.anything_before((box_low, box_high), corners[0], patch.normal)
    }

    fn number_at(&self, square: Square) -> usize {
        self.number[&square.at]
    }
}

impl Square {
    /// Its corner texels, and one in its middle.
    fn probes(self) -> [[u32; 2]; 5] {
        let ([x, y], last) = (self.at, self.size - 1);
        [[x, y], [x + last, y], [x, y + last], [x + last, y + last], [x + self.size / 2, y + self.size / 2]]
    }

    /// Where a texel lies between the corners, 0..1 along each side.
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
    corners.iter().zip(weights).fold([0.0; 3], |sum, (corner, weight)| added(sum, corner.map(|h| h * weight)))
}

/// The bits of both coordinates in turn (Morton 1966): what is near in it is near.
fn interleaved([x, y]: [u32; 2]) -> u64 {
    let spread = |n: u32| (0..32).fold(0u64, |bits, k| bits | u64::from(n >> k & 1) << (2 * k));
    spread(x) | spread(y) << 1
}
