//! The average of a texture over a polygon, exact: texels are squares of one colour.
//!
//! ∬ f dx dy = ∮ G dy, where G(x, y) = ∫_0^x f(x', y) dx' (Green). Inside a texel G is linear along an edge, so its
//! value in the middle of the edge's piece in the texel, times the height of that piece, is exact. The cost of a
//! footprint grows with its outline and not with its area. Texels are squares rather than bilinearly interpolated
//! because both have the same average over whole texels, and because interpolation would reach across the edges of the
//! author's layout.
//!
//! A footprint that is a point or a line up to rounding has no area to divide by, as for faces whose coordinates all
//! lie on one colour of a palette, or along a gradient. In this case, the average over the polygon itself is computed,
//! split at the texels that the line crosses. A texel includes its left and upper border, so a point on the border of
//! two texels has the colour of the one to the right or below, after wrapping.

use super::area_and_middle;
use super::sums::Sums;
use crate::geometry::polygon::{Polygon, part};
use equilux_formats::Rgb;
use equilux_formats::texture::Wrap;
use glam::{DVec2, DVec3};
use smallvec::SmallVec;

/// Footprints in repeating images whose edges cross more texels than this get the average of the image.
const MOST_CROSSINGS: f64 = 1e6;
/// Footprints narrower than this, in texels, are lines: far above rounding, far below what is visible.
const LINE: f64 = 1e-6;

impl Sums<'_> {
    /// The average over a planar convex polygon. `at` returns the texture coordinates of its points.
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

    /// The average over a footprint with these corners, in texels.
    fn inside(&self, corners: &[DVec2]) -> Rgb {
        let from = corners[0];
        let area = edges(corners).map(|(p, q)| (p - from).perp_dot(q - from)).sum::<f64>() / 2.0;
        let mut sum = Rgb::BLACK;
        for (from, to) in edges(corners) {
            for ends in self.stops(from, to).windows(2) {
                let value = self.left_of(between(from, to, ends));
                let rise = (to.y - from.y) * (ends[1] - ends[0]);
                (0..3).for_each(|c| sum[c] += value[c] * rise);
            }
        }
        sum / area
    }

    /// The average over a polygon whose footprint is a line. `at` returns the position of its points, in texels.
    fn along_line(&self, polygon: &[DVec3], at: impl Fn(DVec3) -> DVec2, [from, to]: [DVec2; 2]) -> Rgb {
        let along = to - from;
        let share = |p: DVec3| (at(p) - from).dot(along) / along.length_squared();
        let (mut rest, mut sum, mut whole) = (Some(Polygon::from_slice(polygon)), Rgb::BLACK, 0.0);
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
        if whole > 0.0 { sum / whole } else { self.at((from + to) / 2.0) }
    }

    /// The shares of an edge, 0 to 1, where it passes from texel to texel.
    fn stops(&self, from: DVec2, to: DVec2) -> Vec<f64> {
        let mut stops = vec![0.0, 1.0];
        for axis in 0..2 {
            let (low, high) = (from[axis].min(to[axis]), from[axis].max(to[axis]));
            let (low, high) = match self.texture.wrap[axis] {
                // Beyond the edge of the image all texels are equal.
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
}

/// Corners of a polygon in an image, in texels.
type Footprint = SmallVec<[DVec2; 10]>;

fn edges(corners: &[DVec2]) -> impl Iterator<Item = (DVec2, DVec2)> {
    (0..corners.len()).map(|i| (corners[i], corners[(i + 1) % corners.len()]))
}

/// The point halfway between two shares of an edge; exact for edges along the axes of the image.
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

#[cfg(test)]
mod tests {
    use super::super::Sheet;
    use super::*;
    use equilux_formats::MaterialId;
    use equilux_formats::texture::{Texture, TexturedTriangle};
    use glam::{dvec2, dvec3};
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
            let mut points = Rgb::BLACK;
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

    /// The texel that stands at a column or row.
    fn shown(at: i64, size: i64, wrap: Wrap) -> u32 {
        let shown = match wrap {
            Wrap::Clamp => at.clamp(0, size - 1),
            Wrap::Repeat => at.rem_euclid(size),
            Wrap::Mirror if at.div_euclid(size) % 2 == 0 => at.rem_euclid(size),
            Wrap::Mirror => size - 1 - at.rem_euclid(size),
        };
        shown as u32
    }

    proptest! {
        /// Any part of any face whose coordinates lie on a point, within 1e-7 of it, or on a line inside a texel, in
        /// any copy of the image.
        #[test]
        fn a_point_or_a_line_has_the_colour_of_its_texel(
            size in prop::array::uniform2(1..300_u32),
            texel in prop::array::uniform2(0.0..1.0_f64),
            copy in prop::array::uniform2(-3..1000_i32),
            wrap in prop::array::uniform2(prop::sample::select(WRAPS.to_vec())),
            face in prop::array::uniform3(prop::array::uniform3(-9.0..9.0_f64)),
            off in prop::array::uniform3(prop::array::uniform2(-1.0..1.0_f64)),
            (spread, share) in (0..3, 0.1..0.9_f64),
        ) {
            let across = DVec2::from_array(size.map(f64::from));
            let column_and_row = (DVec2::from_array(texel) * across).floor() + DVec2::from_array(copy.map(f64::from)) * across;
            // Coordinates are f32: at 1000 widths of 300 texels they are off by a hundredth of a texel.
            let place = ((column_and_row + 0.5 + 0.3 * DVec2::from_array(off[0])) / across).as_vec2().as_dvec2();
            let shown = [0, 1].map(|axis| shown(column_and_row[axis] as i64, i64::from(size[axis]), wrap[axis]));
            let places = off.map(|[x, y]| match spread {
                0 => place,
                1 => place + dvec2(x, y) * 1e-7,
                _ => place + dvec2(off[0][0], off[1][1]) * x * 0.05 / across,
            });
            let corners = face.map(DVec3::from_array);
            let [a, b, c] = corners;
            prop_assume!((b - a).cross(c - a).length() > 1e-3);
            let triangle = TexturedTriangle {
                material: MaterialId(0),
                corners,
                colours: [Rgb::WHITE; 3],
                reflectance_at: None,
                emission_at: None,
            };
            let sheet = Sheet::new(&triangle);
            let element = [a.lerp(b, share), b.lerp(c, share), c.lerp(a, share)];
            let texture = bright(size, shown, wrap);
            let found = Sums::new(&texture).mean(&element, |p| sheet.at(p, places));
            prop_assert_eq!(found, [1.0; 3], "{} in a texture of {:?}, {:?}", place, size, wrap);
        }
    }

    #[test]
    fn a_point_on_a_border_has_the_texel_right_of_it_or_below() {
        // Columns of unlike alpha.
        let texels: Vec<[u8; 4]> =
            [1, 2, 3, 4, 1, 2, 3, 4].map(|column| [255, 255, 255, 16 * column]).to_vec();
        for (wrap, borders) in [
            (Wrap::Repeat, [(0.25, 2), (0.5, 3), (0.0, 1), (1.0, 1), (-0.25, 4), (1000.75, 4)]),
            (Wrap::Mirror, [(0.25, 2), (0.5, 3), (0.0, 1), (1.0, 4), (-0.25, 1), (1001.25, 3)]),
            (Wrap::Clamp, [(0.25, 2), (0.5, 3), (0.0, 1), (1.0, 4), (-0.25, 1), (1000.0, 4)]),
        ] {
            let texture = Texture { size: [4, 2], texels: texels.clone(), wrap: [wrap; 2] };
            for (u, column) in borders {
                let found = mean_of(&Sums::new(&texture), &[dvec2(u, 0.5); 3])[0];
                let expected = f64::from(16 * column) / 255.0;
                assert!((found - expected).abs() < 1e-12, "{wrap:?} at {u}: {found}, expected {expected}");
            }
        }
    }
}
