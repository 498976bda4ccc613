//! The texels between which a rectangle of texels is interpolated: on each of its edges the first and the last one that can be.
//! They are the corners of a convex polygon, which is the rectangle itself where all of its texels can be interpolated, and
//! otherwise follows the outline of the chart.
//!
//! Inside, a value is a mean of those at the corners, with the weights
//!
//! ```text
//! w_i = A(i−1, i, i+1) ∏_{j ≠ i−1, i} A(x, j, j+1),   A: area of the triangle of these places
//! ```
//!
//! (Wachspress 1975, "A Rational Finite Element Basis"). On an edge they depend on its ends alone, so neighbouring polygons join; in
//! a rectangle they are those of bilinear interpolation, in a triangle barycentric coordinates.

use super::squares::Square;
use glam::{DVec2, dvec2};
use smallvec::SmallVec;

/// Texels up to this far outside of the polygon get the light of its edge, texels.
const BEYOND: f64 = 1.0;

/// The corners of a polygon of texels, at most two on each edge of a rectangle.
#[derive(Debug, Clone, PartialEq)]
pub struct Knots(SmallVec<[[u32; 2]; 8]>);

impl Knots {
    /// Those of a rectangle, of whose texels `is_inner` can be interpolated; none if these are not in one piece, or reach beyond
    /// the polygon.
    pub fn of(square: Square, is_inner: impl Fn([u32; 2]) -> bool) -> Option<Self> {
        let ([x0, y0], [x1, y1]) = (square.low, square.high);
        let mut knots: SmallVec<[[u32; 2]; 8]> = SmallVec::new();
        let mut add = |edge: &mut dyn Iterator<Item = [u32; 2]>| -> Option<()> {
            let (mut first, mut last, mut has_ended) = (None, None, false);
            for at in edge {
                match (is_inner(at), has_ended) {
                    (true, true) => return None,
                    (true, false) => {
                        first = first.or(Some(at));
                        last = Some(at);
                    }
                    (false, _) => has_ended = first.is_some(),
                }
            }
            for at in [first, last].into_iter().flatten() {
                if !knots.contains(&at) {
                    knots.push(at);
                }
            }
            Some(())
        };
        add(&mut (x0..=x1).map(|x| [x, y0]))?;
        add(&mut (y0..=y1).map(|y| [x1, y]))?;
        add(&mut (x0..=x1).rev().map(|x| [x, y1]))?;
        add(&mut (y0..=y1).rev().map(|y| [x0, y]))?;
        let knots = Self(knots);
        let is_near = |at: [u32; 2]| !is_inner(at) || knots.distance(place(at)) <= BEYOND;
        (!knots.0.is_empty() && square.texels().all(is_near)).then_some(knots)
    }

    /// The texels.
    pub fn all(&self) -> &[[u32; 2]] {
        &self.0
    }

    /// The middle of the polygon, in texels.
    pub fn middle(&self) -> DVec2 {
        self.0.iter().map(|&at| place(at)).sum::<DVec2>() / self.0.len() as f64
    }

    /// The weight of each for the value of a texel, or of the nearest place in the polygon.
    pub fn weights(&self, at: [u32; 2]) -> SmallVec<[f64; 8]> {
        let at = self.pulled_in(place(at));
        let areas: SmallVec<[f64; 8]> =
            self.edges().map(|[a, b]| (b - a).perp_dot(at - a).max(0.0)).collect();
        let count = self.0.len();
        let corner = |i: usize| place(self.0[i % count]);
        let weight = |i: usize| {
            let before = (i + count - 1) % count;
            let own = (corner(i) - corner(before)).perp_dot(corner(i + 1) - corner(i));
            (0..count).filter(|&j| j != i && j != before).map(|j| areas[j]).product::<f64>() * own
        };
        let mut weights: SmallVec<[f64; 8]> = (0..count).map(weight).collect();
        let sum: f64 = weights.iter().sum();
        if sum > 0.0 {
            weights.iter_mut().for_each(|weight| *weight /= sum);
            return weights;
        }
        self.along_a_line(at)
    }

    /// The weights where all lie on one line: of its two ends.
    fn along_a_line(&self, at: DVec2) -> SmallVec<[f64; 8]> {
        let far = |i: usize| place(self.0[i]).distance_squared(place(self.0[0]));
        let last = (0..self.0.len()).max_by(|&a, &b| far(a).total_cmp(&far(b))).unwrap_or(0);
        let (from, along) = (place(self.0[0]), place(self.0[last]) - place(self.0[0]));
        let share = ((at - from).dot(along) / along.length_squared().max(1.0)).clamp(0.0, 1.0);
        let mut weights: SmallVec<[f64; 8]> = SmallVec::from_elem(0.0, self.0.len());
        weights[0] = 1.0 - share;
        weights[last] += share;
        weights
    }

    /// The edges, with the polygon to their left.
    fn edges(&self) -> impl Iterator<Item = [DVec2; 2]> + '_ {
        let count = self.0.len();
        (0..count).map(move |i| [i, (i + 1) % count].map(|i| place(self.0[i])))
    }

    /// How far a place is outside, texels.
    fn distance(&self, at: DVec2) -> f64 {
        (at - self.pulled_in(at)).length()
    }

    /// The place itself, or one on the edge near it.
    fn pulled_in(&self, at: DVec2) -> DVec2 {
        let outside = |&[a, b]: &[DVec2; 2]| (b - a).perp_dot(at - a) < 0.0 || a == b;
        let nearest = |[a, b]: [DVec2; 2]| {
            let along = b - a;
            a + along * ((at - a).dot(along) / along.length_squared().max(1.0)).clamp(0.0, 1.0)
        };
        let found = self.edges().filter(outside).map(nearest);
        found.min_by(|p, q| p.distance_squared(at).total_cmp(&q.distance_squared(at))).unwrap_or(at)
    }
}

fn place([x, y]: [u32; 2]) -> DVec2 {
    dvec2(f64::from(x), f64::from(y))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        /// A chart cut off by any line: weights add up to one, none is negative, and a linear function is reproduced where the
        /// polygon holds the texel.
        #[test]
        fn a_linear_function_is_interpolated_up_to_the_outline(
            (width, height) in (0u32..12, 0u32..12),
            (angle, share) in (0.0..std::f64::consts::TAU, 0.0..1.0_f64),
        ) {
            let square = Square { low: [2, 3], high: [2 + width, 3 + height] };
            let across = DVec2::from_angle(angle);
            let middle = dvec2(2.0 + share * f64::from(width), 3.0 + share * f64::from(height));
            let is_inner = |at: [u32; 2]| across.dot(place(at) - middle) <= 0.0;
            let Some(knots) = Knots::of(square, is_inner) else { return Ok(()) };
            for at in square.texels().filter(|&at| is_inner(at)) {
                let weights = knots.weights(at);
                prop_assert!((weights.iter().sum::<f64>() - 1.0).abs() < 1e-9, "{weights:?}");
                prop_assert!(weights.iter().all(|&weight| weight >= -1e-12), "{weights:?}");
                let found: DVec2 = weights.iter().zip(knots.all()).map(|(&w, &knot)| place(knot) * w).sum();
                let off = (found - place(at)).length();
                prop_assert!(off <= knots.distance(place(at)) + 1e-6, "{at:?} by {off}");
            }
        }

        #[test]
        fn weights_in_a_rectangle_are_bilinear((width, height) in (1u32..12, 1u32..12)) {
            let square = Square { low: [0, 0], high: [width, height] };
            let knots = Knots::of(square, |_| true).expect("it is whole");
            for [x, y] in square.texels() {
                let [s, t] = [f64::from(x) / f64::from(width), f64::from(y) / f64::from(height)];
                for (&[kx, ky], weight) in knots.all().iter().zip(knots.weights([x, y])) {
                    let expected = (if kx == 0 { 1.0 - s } else { s }) * (if ky == 0 { 1.0 - t } else { t });
                    prop_assert!((weight - expected).abs() < 1e-9, "{weight} instead of {expected}");
                }
            }
        }
    }
}
