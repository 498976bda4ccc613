//! The average of a texture over a polygon, exact: texels are squares of one colour.
//!
//! ∬ f dx dy = ∮ G dy, where G(x, y) = ∫_0^x f(x', y) dx' (Green). Inside a texel G is linear along an edge, so its value in
//! the middle of what an edge has of a texel, times the height of that, is exact. What a footprint costs so grows with
//! its outline and not with its area. Squares, and not the bilinear blend that screens show, because both have the same
//! average over whole texels, and because blends would reach across the edge of what an author laid out.
//!
//! A footprint that is a point or a line up to rounding has no area to divide by: faces whose coordinates all lie on one
//! colour of a palette, or along a gradient of it. There the polygon itself is divided by the texels that the line crosses.
//! A texel holds its left and upper border, so a point on the border of two texels has the colour of the one to the right
//! or below, as the image repeats, mirrors or ends there.

use super::area_and_middle;
use crate::form_factor::polygon::{Polygon, part};
use equilux_formats::{Rgb, Texture, Wrap};
use glam::{DVec2, DVec3, dvec2};
use smallvec::SmallVec;

/// The value of a texel of full colour and alpha.
const ONE: f64 = (1_u64 << 32) as f64 * 255.0;
/// Sums along rows are kept at every so many texels.
const STRIDE: usize = 16;
/// Footprints whose edges cross more texels than this, in images that repeat, take the average of the image.
const MOST_CROSSINGS: f64 = 1e6;
/// Footprints narrower than this, in texels, are lines: far more than rounding, far less than would show.
const LINE: f64 = 1e-6;

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

    /// The average over a planar convex polygon, of which `at` says where its points lie, in widths and heights of the image.
    pub(super) fn mean(&self, polygon: &[DVec3], at: impl Fn(DVec3) -> DVec2) -> Rgb {
        let size = DVec2::from_array(self.texture.size.map(f64::from));
        let start = self.period_of(at(polygon[0]) * size);
        let at = |p: DVec3| at(p) * size - start;
        let corners: Footprint = polygon.iter().map(|&p| at(p)).collect();
        let low = corners.iter().copied().fold(DVec2::INFINITY, DVec2::min);
        let high = corners.iter().copied().fold(DVec2::NEG_INFINITY, DVec2::max);
        if (high - low.floor()).max_element() <= 1.0 {
            return self.at(low);
        }
        let outline: f64 = edges(&corners).map(|(from, to)| (to - from).abs().element_sum()).sum();
        if outline > MOST_CROSSINGS && self.texture.wrap != [Wrap::Clamp; 2] {
            return self.whole();
        }
        match line_through(&corners) {
            Some(line) => self.along_line(polygon, at, line),
            None => self.inside(&corners),
        }
    }

    /// Where the image begins of which a place, counted in texels, lies in a copy: numbers near zero keep their digits.
    fn period_of(&self, place: DVec2) -> DVec2 {
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

    /// The average inside corners, counted in texels.
    fn inside(&self, corners: &[DVec2]) -> Rgb {
        let from = corners[0];
        let area = edges(corners).map(|(p, q)| (p - from).perp_dot(q - from)).sum::<f64>() / 2.0;
        let mut sum = [0.0; 3];
        for (from, to) in edges(corners) {
            for ends in self.stops(from, to).windows(2) {
                let value = self.left_of(between(from, to, ends));
                let rise = (to.y - from.y) * (ends[1] - ends[0]);
                (0..3).for_each(|c| sum[c] += value[c] * rise);
            }
        }
        sum.map(|sum| sum / area)
    }

    /// The average over a polygon whose points lie on a line as `at` says, counted in texels.
    fn along_line(&self, polygon: &[DVec3], at: impl Fn(DVec3) -> DVec2, [from, to]: [DVec2; 2]) -> Rgb {
        let along = to - from;
        let share = |p: DVec3| (at(p) - from).dot(along) / along.length_squared();
        let (mut rest, mut sum, mut whole) = (Some(Polygon::from_slice(polygon)), [0.0; 3], 0.0);
        for ends in self.stops(from, to).windows(2) {
            let Some(left) = rest.take() else { break };
            let parts = if ends[1] == 1.0 { [Some(left), None] } else { part(&left, |p| ends[1] - share(p)) };
            let [near, far] = parts;
            rest = far;
            let Some(near) = near else { continue };
            let (area, colour) = (area_and_middle(&near).0, self.at(between(from, to, ends)));
            (0..3).for_each(|c| sum[c] += colour[c] * area);
            whole += area;
        }
        if whole > 0.0 { sum.map(|sum| sum / whole) } else { self.at((from + to) / 2.0) }
    }

    fn whole(&self) -> Rgb {
        let [width, height] = self.texture.size.map(|size| size as usize);
        let rows = (0..height).map(|row| self.before(width, row).map(|sum| sum as f64));
        let sum = rows.fold([0.0; 3], |sum: Rgb, row| std::array::from_fn(|c| sum[c] + row[c]));
        sum.map(|sum| sum / (ONE * (width * height) as f64))
    }

    /// Where an edge passes from texel to texel, in shares of it from 0 to 1.
    fn stops(&self, from: DVec2, to: DVec2) -> Vec<f64> {
        let mut stops = vec![0.0, 1.0];
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
        stops.dedup();
        stops
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

/// Corners of a polygon in an image, counted in texels.
type Footprint = SmallVec<[DVec2; 10]>;

fn edges(corners: &[DVec2]) -> impl Iterator<Item = (DVec2, DVec2)> {
    (0..corners.len()).map(|i| (corners[i], corners[(i + 1) % corners.len()]))
}

/// The place halfway between two shares of an edge; on a line along the image that the edge lies on.
fn between(from: DVec2, to: DVec2, ends: &[f64]) -> DVec2 {
    from + (to - from) * ((ends[0] + ends[1]) / 2.0)
}

/// The ends of a footprint that is a line up to rounding.
fn line_through(corners: &[DVec2]) -> Option<[DVec2; 2]> {
    let farthest = |from: DVec2| {
        let by_distance =
            |a: &DVec2, b: &DVec2| (*a - from).length_squared().total_cmp(&(*b - from).length_squared());
        corners.iter().copied().max_by(by_distance).expect("a polygon has corners")
    };
    let to = farthest(corners[0]);
    let from = farthest(to);
    let across = (to - from).perp().normalize_or_zero();
    let aside = corners.iter().map(|&corner| across.dot(corner - from));
    let (low, high) = aside.fold((0.0_f64, 0.0_f64), |(low, high), d| (low.min(d), high.max(d)));
    (high - low <= LINE).then_some([from, to])
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
    use equilux_formats::{MaterialId, TexturedTriangle};
    use glam::dvec3;
    use proptest::prelude::*;

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
            let mean = mean_of(&sums, &quad);
            let mut reversed = quad;
            reversed.reverse();
            let digits = |mean: Rgb| mean.map(|x| (x * 1e9).round());
            assert_eq!(digits(mean_of(&sums, &reversed)), digits(mean));
            let far = quad.map(|place| place + dvec2(1000.0, -74.0));
            assert!(wrap.contains(&Wrap::Clamp) || digits(mean_of(&sums, &far)) == digits(mean), "{wrap:?}");
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

    /// The mean over a polygon that lies in the image itself.
    fn mean_of(sums: &Sums, places: &[DVec2]) -> Rgb {
        let polygon: Vec<DVec3> = places.iter().map(|place| place.extend(0.0)).collect();
        sums.mean(&polygon, DVec3::truncate)
    }

    #[test]
    fn what_reaches_over_too_many_texels_has_the_mean_of_all() {
        let texture =
            Texture { size: [2, 1], texels: vec![[255; 4], [0, 0, 0, 255]], wrap: [Wrap::Repeat; 2] };
        let far = [DVec2::ZERO, dvec2(1e9, 0.0), dvec2(0.0, 1e9)];
        assert_eq!(mean_of(&Sums::new(&texture), &far), [0.5; 3], "half of the image");
    }

    /// A triangle (0, 0), (1, 0), (1, 1) whose coordinates lie on a line: x² of it lies left of x.
    #[test]
    fn a_line_has_what_of_the_surface_lies_along_it() {
        let texture =
            Texture { size: [2, 1], texels: vec![[255; 4], [0, 0, 0, 255]], wrap: [Wrap::Repeat; 2] };
        let sums = Sums::new(&texture);
        let triangle = [DVec3::ZERO, DVec3::X, dvec3(1.0, 1.0, 0.0)];
        for (v, slope) in [(0.5, 0.0), (0.0, 0.0), (1.0, 0.0), (-0.2, 0.4), (0.3, 1e-8)] {
            let white = sums.mean(&triangle, |p| dvec2(0.8 * p.x, v + slope * p.x))[0];
            assert!((white - 0.625 * 0.625).abs() < 1e-9, "{white} along v = {v} + {slope} x");
        }
    }

    /// Case 34: one bright texel among dark ones.
    fn bright(size: [u32; 2], at: [u32; 2], wrap: [Wrap; 2]) -> Texture {
        let texel = |i: u32| if [i % size[0], i / size[0]] == at { [255; 4] } else { [10, 10, 10, 255] };
        Texture { size, texels: (0..size[0] * size[1]).map(texel).collect(), wrap }
    }

    proptest! {
        /// Any part of any face whose coordinates lie on a point, on a line inside a row of texels, or within 1e-7 of a point.
        #[test]
        fn a_point_or_a_line_has_the_colour_of_its_texel(
            size in prop::array::uniform2(1..300_u32),
            (u, v) in (prop::array::uniform2(0.0..1.0_f64), prop::array::uniform2(-3..1000_i32)),
            wrap in prop::array::uniform2(prop::sample::select(WRAPS.to_vec())),
            face in prop::array::uniform3(prop::array::uniform3(-9.0..9.0_f64)),
            jitter in prop::array::uniform3(prop::array::uniform2(-1.0..1.0_f64)),
            (spread, share) in (0..3, 0.1..0.9_f64),
        ) {
            let (size_of, copy) = (DVec2::from_array(size.map(f64::from)), DVec2::from_array(v.map(f64::from)));
            // Not nearer to the border of a texel than the spread, and than what f32 coordinates are rounded by.
            let inside = (DVec2::from_array(u) * size_of).floor() + 0.5 + 0.3 * (DVec2::from_array(jitter[0]));
            let copy = DVec2::select(DVec2::from_array(u).cmplt(DVec2::splat(0.5)), copy, DVec2::ZERO);
            let place = (inside / size_of + copy).as_vec2().as_dvec2();
            let at = |axis: usize| {
                let (texels, texel) = (i64::from(size[axis]), (place[axis] * size_of[axis]).floor() as i64);
                (match wrap[axis] {
                    Wrap::Clamp => texel.clamp(0, texels - 1),
                    Wrap::Repeat => texel.rem_euclid(texels),
                    Wrap::Mirror => {
                        let there = texel.rem_euclid(2 * texels);
                        there.min(2 * texels - 1 - there)
                    }
                }) as u32
            };
            let texture = bright(size, [at(0), at(1)], wrap);
            prop_assume!(copy == DVec2::ZERO || (place * size_of).fract_gl().cmpgt(DVec2::splat(0.1)).all());
            let off = jitter.map(|[x, y]| match spread {
                0 => DVec2::ZERO,
                1 => dvec2(x, y) * 1e-7,
                // Along a line of whatever slope, inside the texel.
                _ => (dvec2(jitter[0][0], jitter[1][1]) * x * 0.05) / size_of,
            });
            let [a, b, c] = face.map(DVec3::from_array);
            let normal = (b - a).cross(c - a);
            prop_assume!(normal.length() > 1e-3);
            let places = off.map(|off| place + off);
            let triangle = TexturedTriangle {
                material: MaterialId(0),
                corners: [a, b, c],
                colours: [[1.0; 3]; 3],
                reflectance_at: None,
                emission_at: None,
            };
            let sheet = super::super::Sheet::new(&triangle);
            let element = [a.lerp(b, share), b.lerp(c, share), c.lerp(a, share)];
            let found = Sums::new(&texture).mean(&element, |p| sheet.at(p, places));
            prop_assert_eq!(found, [1.0; 3], "{} in a texture of {:?}, {:?}", place, size, wrap);
        }
    }

    #[test]
    fn a_point_on_a_border_has_the_texel_right_of_it_or_below() {
        // Columns of 1, 2, 3 and 4 sixteenths of full colour.
        let texels = (1..=4_u8).flat_map(|column| [[255, 255, 255, 16 * column - 1]; 1]).collect::<Vec<_>>();
        let texels = [texels.clone(), texels].concat();
        for (wrap, borders) in [
            (Wrap::Repeat, [(0.25, 2), (0.5, 3), (0.0, 1), (1.0, 1), (-0.25, 4), (1000.75, 4)]),
            (Wrap::Mirror, [(0.25, 2), (0.5, 3), (0.0, 1), (1.0, 4), (-0.25, 1), (1001.25, 3)]),
            (Wrap::Clamp, [(0.25, 2), (0.5, 3), (0.0, 1), (1.0, 4), (-0.25, 1), (1000.0, 4)]),
        ] {
            let texture = Texture { size: [4, 2], texels: texels.clone(), wrap: [wrap; 2] };
            for (u, column) in borders {
                let found = mean_of(&Sums::new(&texture), &[dvec2(u, 0.5); 3])[0];
                let expected = f64::from(16 * column - 1) / 255.0;
                assert!((found - expected).abs() < 1e-12, "{wrap:?} at {u}: {found}, expected {expected}");
            }
        }
    }
}
