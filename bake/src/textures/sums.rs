//! A texture with prefix sums for computing averages: colours of single texels, and sums along rows, with wrapping.
//! Positions are in texels.

use equilux_formats::Rgb;
use equilux_formats::texture::{Texture, Wrap};
use glam::{DVec2, dvec2};

/// The value of a texel with full colour and alpha.
const ONE: f64 = (1_u64 << 32) as f64 * 255.0;
/// Distance of stored sums along rows, in texels.
const STRIDE: usize = 16;

/// A texture with sums along its rows.
#[derive(Debug)]
pub(super) struct Sums<'a> {
    pub(super) texture: &'a Texture,
    /// Linear values of sRGB bytes, of 2^32.
    linear: [u64; 256],
    /// For each row the sums of its texels before every [`STRIDE`]-th, and of all.
    sums: Vec<[u64; 3]>,
    per_row: usize,
}

impl<'a> Sums<'a> {
    /// The sums of `texture`.
    pub(super) fn new(texture: &'a Texture) -> Self {
        let width = texture.size[0] as usize;
        let per_row = width / STRIDE + 2;
        let linear = std::array::from_fn(|byte| (linear(byte as f64 / 255.0) * 2f64.powi(32)).round() as u64);
        let mut sums = Self { texture, linear, sums: Vec::new(), per_row };
        for row in 0..texture.size[1] as usize {
            let (mut sum, mut of_row) = ([0; 3], Vec::with_capacity(per_row));
            for column in 0..width {
                if column % STRIDE == 0 {
                    of_row.push(sum);
                }
                sum = plus(sum, sums.texel(column, row));
            }
            of_row.resize(per_row, sum);
            sums.sums.extend(of_row);
        }
        sums
    }

    /// The start of the copy of the image that a position, in texels, lies in. Positions relative to it keep their digits.
    pub(super) fn period_of(&self, place: DVec2) -> DVec2 {
        let start = |axis: usize| {
            let size = f64::from(self.texture.size[axis]);
            match self.texture.wrap[axis] {
                Wrap::Repeat => (place[axis] / size).floor() * size,
                Wrap::Mirror => (place[axis] / (2.0 * size)).floor() * 2.0 * size,
                Wrap::Clamp => 0.0,
            }
        };
        dvec2(start(0), start(1))
    }

    /// The average of the whole image.
    pub(super) fn whole(&self) -> Rgb {
        let [width, height] = self.texture.size.map(|size| size as usize);
        let sum: Rgb = (0..height).map(|row| Rgb(self.before(width, row).map(|sum| sum as f64))).sum();
        sum / (ONE * (width * height) as f64)
    }

    /// The colour at a position, in texels.
    pub(super) fn at(&self, place: DVec2) -> Rgb {
        let [column, row] = [0, 1].map(|axis| self.wrapped(place[axis].floor(), axis));
        Rgb(self.texel(column, row).map(|value| value as f64 / ONE))
    }

    /// The sum of the colours along a row from column 0 to a position, in texels; negative to the left.
    pub(super) fn left_of(&self, place: DVec2) -> Rgb {
        let (row, column) = (self.wrapped(place.y.floor(), 1), place.x.floor());
        let (whole, texel) = (self.along(column, row), self.at(place));
        whole + texel * (place.x - column)
    }

    /// The sum from column 0 to any column; negative to the left.
    fn along(&self, column: f64, row: usize) -> Rgb {
        let width = self.texture.size[0] as usize;
        let sum = |column: usize| Rgb(self.before(column, row).map(|sum| sum as f64 / ONE));
        let total = sum(width);
        let (periods, rest) = match self.texture.wrap[0] {
            Wrap::Repeat => (column.div_euclid(width as f64), sum(column.rem_euclid(width as f64) as usize)),
            Wrap::Mirror => {
                let (there_and_back, at) = (2 * width, column.rem_euclid(2.0 * width as f64) as usize);
                let back = |at| {
                    let left = sum(there_and_back - at);
                    total * 2.0 - left
                };
                let rest = if at <= width { sum(at) } else { back(at) };
                (2.0 * column.div_euclid(there_and_back as f64), rest)
            }
            Wrap::Clamp => {
                let beyond = column - column.clamp(0.0, width as f64);
                let (edge, inside) = (self.at(dvec2(column, row as f64)), sum((column - beyond) as usize));
                return inside + edge * beyond;
            }
        };
        total * periods + rest
    }

    /// The texel at a column (axis 0) or row (axis 1), after wrapping.
    fn wrapped(&self, at: f64, axis: usize) -> usize {
        let size = f64::from(self.texture.size[axis]);
        let inside = match self.texture.wrap[axis] {
            Wrap::Repeat => at.rem_euclid(size),
            Wrap::Mirror => {
                let at = at.rem_euclid(2.0 * size);
                at.min(2.0 * size - 1.0 - at)
            }
            Wrap::Clamp => at.clamp(0.0, size - 1.0),
        };
        (inside as usize).min(self.texture.size[axis] as usize - 1)
    }

    /// The sum of a row's texels before `column`, which is at most its width.
    fn before(&self, column: usize, row: usize) -> [u64; 3] {
        let kept = self.sums[row * self.per_row + column / STRIDE];
        (column / STRIDE * STRIDE..column).fold(kept, |sum, column| plus(sum, self.texel(column, row)))
    }

    fn texel(&self, column: usize, row: usize) -> [u64; 3] {
        let [red, green, blue, alpha] = self.texture.texels[row * self.texture.size[0] as usize + column];
        [red, green, blue].map(|byte| self.linear[usize::from(byte)] * u64::from(alpha))
    }
}

fn plus(a: [u64; 3], b: [u64; 3]) -> [u64; 3] {
    std::array::from_fn(|c| a[c] + b[c])
}

/// Linear light of an sRGB value, both 0..1. IEC 61966-2-1.
fn linear(value: f64) -> f64 {
    if value <= 0.04045 { value / 12.92 } else { ((value + 0.055) / 1.055).powf(2.4) }
}
