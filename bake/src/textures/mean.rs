//! The average of a texture over a polygon, exact: texels are squares of one colour.
//!
//! ∬ f dx dy = ∮ G dy, where G(x, y) = ∫_0^x f(x', y) dx' (Green). Inside a texel G is linear along an edge, so its value in
//! the middle of what an edge has of a texel, times the height of that, is exact. What a footprint costs so grows with
//! its outline and not with its area. Squares, and not the bilinear blend that screens show, because both have the same
//! average over whole texels, and because blends would reach across the edge of what an author laid out.

use equilux_formats::{Rgb, Texture, Wrap};
use glam::{DVec2, dvec2};

/// The value of a texel of full colour and alpha.
const ONE: f64 = (1_u64 << 32) as f64 * 255.0;
/// Sums along rows are kept at every so many texels.
const STRIDE: usize = 16;
/// Footprints whose edges cross more texels than this, in images that repeat, take the average of the image.
const MOST_CROSSINGS: f64 = 1e6;
/// Footprints of less area than this, in squares of their outline, are lines.
const LINE: f64 = 1e-9;

/// A texture with sums along its rows.
pub(super) struct Sums<'a> {
    texture: &'a Texture,
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

    /// The average over the polygon with these corners, in widths and heights of the image; of what has no area, over its
    /// outline; of a point, its texel.
    pub(super) fn mean(&self, corners: &[DVec2]) -> Rgb {
        let [width, height] = self.texture.size.map(f64::from);
        let corners: Vec<DVec2> = corners.iter().map(|corner| *corner * dvec2(width, height)).collect();
        let edges = || (0..corners.len()).map(|i| (corners[i], corners[(i + 1) % corners.len()]));
        let outline: f64 = edges().map(|(from, to)| (to - from).abs().element_sum()).sum();
        if outline > MOST_CROSSINGS && self.texture.wrap != [Wrap::Clamp; 2] {
            return self.whole();
        }
        let from = corners[0];
        let area = edges().map(|(p, q)| (p - from).perp_dot(q - from)).sum::<f64>() / 2.0;
        let line = area.abs() <= LINE * outline * outline;
        let (mut sum, mut weight) = ([0.0; 3], 0.0);
        for (from, to) in edges() {
            self.walk(from, to, |middle, length, rise| {
                let (value, step) = match line {
                    true => (self.at(middle), length),
                    false => (self.left_of(middle), rise),
                };
                (0..3).for_each(|c| sum[c] += value[c] * step);
                weight += if line { length } else { 0.0 };
            });
        }
        let weight = if line { weight } else { area };
        if weight == 0.0 { self.at(from) } else { sum.map(|sum| sum / weight) }
    }

    fn whole(&self) -> Rgb {
        let [width, height] = self.texture.size.map(|size| size as usize);
        let rows = (0..height).map(|row| self.before(width, row).map(|sum| sum as f64));
        let sum = rows.fold([0.0; 3], |sum: Rgb, row| std::array::from_fn(|c| sum[c] + row[c]));
        sum.map(|sum| sum / (ONE * (width * height) as f64))
    }

    /// Each piece that an edge has of a texel: its middle, length, and rise along y.
    fn walk(&self, from: DVec2, to: DVec2, mut piece: impl FnMut(DVec2, f64, f64)) {
        let mut stops = vec![1.0];
        for axis in 0..2 {
            let (low, high) = (from[axis].min(to[axis]), from[axis].max(to[axis]));
            let (low, high) = match self.texture.wrap[axis] {
                // Beyond the edge all texels are one.
                Wrap::Clamp => (low.max(-1.0), high.min(f64::from(self.texture.size[axis]) + 1.0)),
                Wrap::Repeat | Wrap::Mirror => (low, high),
            };
            let lines = (low.ceil() as i64)..=(high.floor() as i64);
            stops.extend(lines.map(|line| (line as f64 - from[axis]) / (to[axis] - from[axis])));
        }
        stops.retain(|stop| (0.0..=1.0).contains(stop));
        stops.sort_unstable_by(f64::total_cmp);
        let mut start = 0.0;
        for stop in stops {
            let share = stop - start;
            if share > 0.0 {
                let middle = from.lerp(to, (start + stop) / 2.0);
                piece(middle, (to - from).length() * share, (to.y - from.y) * share);
            }
            start = stop;
        }
    }

    /// The colour at a place, counted in texels.
    fn at(&self, place: DVec2) -> Rgb {
        let [column, row] = [0, 1].map(|axis| self.wrapped(place[axis].floor(), axis));
        self.texel(column, row).map(|value| value as f64 / ONE)
    }

    /// G at a place, counted in texels.
    fn left_of(&self, place: DVec2) -> Rgb {
        let (row, column) = (self.wrapped(place.y.floor(), 1), place.x.floor());
        let (whole, texel) = (self.along(column, row), self.at(place));
        std::array::from_fn(|c| whole[c] + texel[c] * (place.x - column))
    }

    /// The sum from column 0 to any, left of it counted as negative.
    fn along(&self, column: f64, row: usize) -> Rgb {
        let width = self.texture.size[0] as usize;
        let sum = |column: usize| self.before(column, row).map(|sum| sum as f64 / ONE);
        let total = sum(width);
        let (periods, rest) = match self.texture.wrap[0] {
            Wrap::Repeat => (column.div_euclid(width as f64), sum(column.rem_euclid(width as f64) as usize)),
            Wrap::Mirror => {
                let (there_and_back, at) = (2 * width, column.rem_euclid(2.0 * width as f64) as usize);
                let back = |at| {
                    let left = sum(there_and_back - at);
                    std::array::from_fn(|c| 2.0 * total[c] - left[c])
                };
                let rest = if at <= width { sum(at) } else { back(at) };
                (2.0 * column.div_euclid(there_and_back as f64), rest)
            }
            Wrap::Clamp => {
                let beyond = column - column.clamp(0.0, width as f64);
                let (edge, inside) = (self.at(dvec2(column, row as f64)), sum((column - beyond) as usize));
                return std::array::from_fn(|c| inside[c] + edge[c] * beyond);
            }
        };
        std::array::from_fn(|c| periods * total[c] + rest[c])
    }

    /// The texel that stands at a column (axis 0) or row (axis 1).
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

#[cfg(test)]
mod tests {
    use super::*;

    const WRAPS: [Wrap; 3] = [Wrap::Repeat, Wrap::Mirror, Wrap::Clamp];

    /// 37 × 5 texels of unlike colours.
    fn texture(wrap: [Wrap; 2]) -> Texture {
        let texels = (0..37 * 5_u32).map(|i| [i * 91, i * 57 + 3, i * i, 90 + i].map(|x| x as u8)).collect();
        Texture { size: [37, 5], texels, wrap }
    }

    /// A quad that lies askew, against the mean of points in it: midpoints of 400 × 400 cells, so that only cells on the
    /// outlines of texels err, some 0.3 % of all by half of what differs there.
    #[test]
    fn mean_is_that_of_points_in_the_footprint() {
        for wrap in WRAPS.iter().flat_map(|&u| WRAPS.map(|v| [u, v])) {
            let texture = texture(wrap);
            let sums = Sums::new(&texture);
            let (from, u, v) = (dvec2(-1.3, 2.7), dvec2(2.9, 0.4), dvec2(-0.3, -3.8));
            let quad = [from, from + u, from + u + v, from + v];
            let mean = sums.mean(&quad);
            let mut reversed = quad;
            reversed.reverse();
            assert_eq!(sums.mean(&reversed).map(|x| (x * 1e9).round()), mean.map(|x| (x * 1e9).round()));
            let mut points = [0.0; 3];
            for k in 0..160_000 {
                let (s, t) = ((f64::from(k % 400) + 0.5) / 400.0, (f64::from(k / 400) + 0.5) / 400.0);
                let colour = sums.at((from + u * s + v * t) * dvec2(37.0, 5.0));
                (0..3).for_each(|c| points[c] += colour[c] / 160_000.0);
            }
            for c in 0..3 {
                assert!((mean[c] - points[c]).abs() < 2e-3, "{wrap:?}: {mean:?}, points have {points:?}");
            }
        }
    }

    #[test]
    fn lines_points_and_the_whole_have_their_colours() {
        let texture = Texture {
            size: [2, 1],
            texels: vec![[255; 4], [0, 0, 0, 255]],
            wrap: [Wrap::Repeat, Wrap::Repeat],
        };
        let sums = Sums::new(&texture);
        assert_eq!(sums.mean(&[dvec2(0.25, 0.5); 3]), [1.0; 3], "a point of the white texel");
        let line = [dvec2(0.0, 0.5), dvec2(0.8, 0.5), dvec2(0.8, 0.5)];
        assert!((sums.mean(&line)[0] - 0.625).abs() < 1e-12, "0.5 of 0.8 are white");
        let far = [DVec2::ZERO, dvec2(1e9, 0.0), dvec2(0.0, 1e9)];
        assert_eq!(sums.mean(&far), [0.5; 3], "half of the image");
    }
}
