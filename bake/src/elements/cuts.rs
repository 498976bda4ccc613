//! Cuts a triangle or quad into pieces whose edges are no longer than a given size, and counts the pieces beforehand.
//!
//! Quads become grids, triangles n² triangles similar to the whole. In a sliver, such pieces would be far narrower than
//! the size, and their number would grow with the square of its length. A sliver is therefore cut into rows across its
//! two long edges, and each row into as many pieces as its width requires. No piece has more than four corners.
//! Neighbouring pieces need not share whole edges.

use crate::geometry::tolerance::SAME_LENGTH;
use equilux_formats::Corners;
use glam::DVec3;
use smallvec::{SmallVec, smallvec};

/// A triangle whose longest edge exceeds this multiple of its height is a sliver.
const SLIVER_ASPECT: f64 = 4.0;
/// Rows run along the shortest edge if it is at most this multiple of the triangle's height; longer edges make skewed rows.
const MAX_SKEW: f64 = 2.0;
/// How a triangle or quad, or a piece of one, is cut.
enum Pattern {
    /// The number of quads along the first and along the second edge. Neighbours share bit-identical corners.
    Grid([DVec3; 4], [usize; 2]),
    /// n² triangles similar to the whole; the field is n. Neighbours share bit-identical corners.
    Similar([DVec3; 3], usize),
    /// `rows` of equal height between the edges from the first corner to the others; row k, counted from 1 at that corner, has
    /// ⌈k · `widest` / `rows`⌉ pieces.
    Rows { corners: [DVec3; 3], rows: usize, widest: usize },
}

/// The number of pieces that [`cut`] makes.
pub fn count(corners: &Corners, size: f64) -> u128 {
    total(&patterns(corners, size))
}

/// Cuts a planar convex polygon into pieces whose edges are no longer than `size`, in the unit of the corners, and
/// calls `emit` with each.
pub fn cut(corners: &Corners, size: f64, mut emit: impl FnMut(Corners)) {
    patterns(corners, size).iter().for_each(|pattern| pattern.cut(&mut emit));
}

fn patterns(corners: &Corners, size: f64) -> SmallVec<[Pattern; 4]> {
    match *corners.as_slice() {
        [a, b, c] => of_triangle([a, b, c], size),
        [a, b, c, d] => of_quad([a, b, c, d], size),
        _ => unreachable!("a surface has three or four corners"),
    }
}

/// A grid, or, where a skewed quad would need far too many pieces, the two triangles beside its shorter diagonal.
fn of_quad([a, b, c, d]: [DVec3; 4], size: f64) -> SmallVec<[Pattern; 4]> {
    let (width, length) = ((b - a).length().max((c - d).length()), (d - a).length().max((c - b).length()));
    let [across, along] = [width, length].map(|edge| pieces(edge, size));
    let grid = Pattern::Grid([a, b, c, d], [across, along]);
    let area = Corners::quad([a, b, c, d]).double_area_vector().length() / 2.0;
    if across == 1 || along == 1 || !exceeds(width * length, SLIVER_ASPECT * area) {
        return smallvec![grid];
    }
    let halves = match exceeds((c - a).length(), (d - b).length()) {
        true => [[a, b, d], [b, c, d]],
        false => [[a, b, c], [a, c, d]],
    };
    let halves: SmallVec<[Pattern; 4]> =
        halves.into_iter().flat_map(|half| of_triangle(half, size)).collect();
    if total(&halves) < grid.count() { halves } else { smallvec![grid] }
}

fn of_triangle([a, b, c]: [DVec3; 3], size: f64) -> SmallVec<[Pattern; 4]> {
    let longest = (b - a).length().max((c - b).length()).max((a - c).length());
    let height = Corners::triangle([a, b, c]).double_area_vector().length() / longest;
    let count = pieces(longest, size);
    if count == 1 || !exceeds(longest, SLIVER_ASPECT * height) {
        return smallvec![Pattern::Similar([a, b, c], count)];
    }
    let turned = [[a, b, c], [b, c, a], [c, a, b]];
    let short = |[_, p, q]: &[DVec3; 3]| (q - p).length();
    let [tip, p, q] = turned.into_iter().min_by(|s, t| short(s).total_cmp(&short(t))).expect("three");
    let across = (q - p).length();
    let widest = pieces(across, size);
    if widest == 1 || !exceeds(across, MAX_SKEW * height) {
        return smallvec![Pattern::Rows { corners: [tip, p, q], rows: count, widest }];
    }
    // An obtuse sliver: rows along its height, from both ends of its longest edge.
    let foot = |to: DVec3, apex: DVec3| {
        let along = to - tip;
        tip + along * ((apex - tip).dot(along) / along.length_squared())
    };
    let halves = if (p - tip).length() > (q - tip).length() {
        let foot = foot(p, q);
        [[tip, foot, q], [p, q, foot]]
    } else {
        let foot = foot(q, p);
        [[tip, p, foot], [q, foot, p]]
    };
    let rows = |corners @ [tip, p, q]: [DVec3; 3]| {
        let rows = pieces((p - tip).length().max((q - tip).length()), size);
        Pattern::Rows { corners, rows, widest: pieces(height, size) }
    };
    halves.into_iter().map(rows).collect()
}

/// Whether one length or area exceeds another by more than rounding.
fn exceeds(one: f64, other: f64) -> bool {
    one > other * (1.0 + SAME_LENGTH)
}

/// The number of pieces an edge needs. Rounding does not add a piece.
fn pieces(length: f64, size: f64) -> usize {
    ((length / size) * (1.0 - SAME_LENGTH)).ceil().max(1.0) as usize
}

fn total(patterns: &[Pattern]) -> u128 {
    patterns.iter().map(Pattern::count).fold(0, u128::saturating_add)
}

impl Pattern {
    fn count(&self) -> u128 {
        let wide = |n: usize| n as u128;
        match *self {
            Self::Grid(_, [across, along]) => wide(across) * wide(along),
            Self::Similar(_, n) => wide(n) * wide(n),
            // Σ_{k=1..n} ⌈k m / n⌉ = (m n + m + n − gcd(m, n)) / 2: lattice points below a diagonal.
            Self::Rows { rows, widest, .. } => {
                let (n, m) = (wide(rows), wide(widest));
                (n * m + m + n - greatest_common_divisor(n, m)) / 2
            }
        }
    }

    fn cut(&self, emit: &mut impl FnMut(Corners)) {
        match *self {
            Self::Grid(corners, counts) => cut_grid(corners, counts, emit),
            Self::Similar(corners, n) => cut_similar(corners, n, emit),
            Self::Rows { corners, rows, widest } => cut_rows(corners, rows, widest, emit),
        }
    }
}

fn greatest_common_divisor(a: u128, b: u128) -> u128 {
    if b == 0 { a } else { greatest_common_divisor(b, a % b) }
}

/// The point after i of n equal steps from a to b. Exact at both ends; if both ends lie on a coordinate plane, so does
/// the point.
fn step(a: DVec3, b: DVec3, i: usize, n: usize) -> DVec3 {
    if i == n { b } else { a + (b - a) * (i as f64 / n as f64) }
}

fn cut_grid([a, b, c, d]: [DVec3; 4], [across, along]: [usize; 2], emit: &mut impl FnMut(Corners)) {
    let at = |i, j| step(step(a, b, i, across), step(d, c, i, across), j, along);
    for j in 0..along {
        for i in 0..across {
            emit(Corners::quad([at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)]));
        }
    }
}

fn cut_similar([a, b, c]: [DVec3; 3], n: usize, emit: &mut impl FnMut(Corners)) {
    let at = |i: usize, j: usize| step(step(a, c, j, n), step(b, c, j, n), i, (n - j).max(1));
    for j in 0..n {
        for i in 0..n - j {
            emit(Corners::triangle([at(i, j), at(i + 1, j), at(i, j + 1)]));
            if i + j + 1 < n {
                emit(Corners::triangle([at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)]));
            }
        }
    }
}

fn cut_rows([tip, p, q]: [DVec3; 3], rows: usize, widest: usize, emit: &mut impl FnMut(Corners)) {
    for row in 1..=rows {
        let wide = (row * widest).div_ceil(rows);
        let at = |line: usize, j: usize| step(step(tip, p, line, rows), step(tip, q, line, rows), j, wide);
        for j in 0..wide {
            let [near, far] = [row - 1, row].map(|line| [at(line, j), at(line, j + 1)]);
            emit(match row {
                1 => Corners::triangle([tip, far[0], far[1]]),
                _ => Corners::quad([near[0], far[0], far[1], near[1]]),
            });
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::dvec3;
    use proptest::prelude::*;

    fn area(corners: &Corners) -> f64 {
        corners.double_area_vector().length() / 2.0
    }

    fn edges(corners: &Corners) -> impl Iterator<Item = f64> {
        let points = corners.as_slice().to_vec();
        (0..points.len()).map(move |i| (points[(i + 1) % points.len()] - points[i]).length())
    }

    /// A triangle of this length and height over its longest edge, whose apex stands at a share of that, turned in space;
    /// or the parallelogram of which it is a half.
    fn shape() -> impl Strategy<Value = Corners> {
        let sizes = (0.02..20.0_f64, 1.2..2000.0_f64, 0.0..=1.0_f64, any::<bool>(), 0..3_usize);
        let turn = (-3.0..3.0_f64, -3.0..3.0_f64, -3.0..3.0_f64);
        (sizes, turn).prop_map(|((length, aspect, apex, is_quad, first), (x, y, z))| {
            let turn = glam::DQuat::from_euler(glam::EulerRot::XYZ, x, y, z);
            let [a, b, c] = [[0.0, 0.0], [length, 0.0], [apex * length, length / aspect]]
                .map(|[x, y]| turn * dvec3(x, y, 0.0) + dvec3(1.0, -2.0, 3.0));
            let mut triangle = [a, b, c];
            triangle.rotate_left(first);
            match is_quad {
                true => Corners::quad([
                    triangle[0],
                    triangle[1],
                    triangle[2],
                    triangle[0] + triangle[2] - triangle[1],
                ]),
                false => Corners::triangle(triangle),
            }
        })
    }

    proptest! {
        /// The pieces are planar, convex and small enough, their number is the one counted, and they tile the whole:
        /// any point lies in one of them, and their areas add up.
        #[test]
        fn pieces_tile_the_whole(whole in shape(), size in 0.05..3.0_f64, [s, t] in prop::array::uniform2(0.0..1.0_f64)) {
            prop_assume!(count(&whole, size) < 20_000);
            let normal = whole.double_area_vector().normalize();
            let points = whole.as_slice();
            let (p, q) = (points[0].lerp(points[1], s), points[points.len() - 1].lerp(points[2], s));
            let place = p.lerp(q, t);
            let (mut number, mut sum, mut holding) = (0, 0.0, 0);
            cut(&whole, size, |piece| {
                number += 1;
                sum += area(&piece);
                let corners = piece.as_slice();
                let side = |i: usize, point: DVec3| {
                    let (a, b) = (corners[i], corners[(i + 1) % corners.len()]);
                    (b - a).normalize_or_zero().cross(point - a).dot(normal)
                };
                let all = |point: DVec3, slack: f64| (0..corners.len()).all(|i| side(i, point) >= -slack);
                // Coordinates up to 25 m: rounding of f64.
                assert!(corners.iter().all(|&corner| all(corner, 1e-13)), "not convex: {piece:?}");
                assert!(edges(&piece).all(|edge| edge <= size * (1.0 + 2.0 * SAME_LENGTH)), "{piece:?}");
                holding += usize::from(all(place, 1e-13));
            });
            prop_assert_eq!(number as u128, count(&whole, size));
            prop_assert!((sum / area(&whole) - 1.0).abs() < 1e-9, "{} m² of {}", sum, area(&whole));
            prop_assert!(holding >= 1, "no piece holds {}", place);
        }

        /// Case 36, for any sliver of at least one piece's length: the number of pieces is in proportion to its area.
        #[test]
        fn slivers_have_no_more_pieces_than_their_area_and_length_ask_for(whole in shape(), size in 0.003..3.0_f64) {
            let points = whole.as_slice();
            let apart = |&p: &DVec3| points.iter().map(move |&q| (q - p).length());
            let longest = points.iter().flat_map(apart).fold(0.0, f64::max);
            let height = 2.0 * area(&whole) / longest;
            prop_assume!(longest > size && longest > 4.1 * height);
            let most = 4.0 * area(&whole) / (size * size) + 2.0 * longest / size;
            prop_assert!(count(&whole, size) as f64 <= most, "{} pieces, at most {}", count(&whole, size), most);
        }
    }

    /// What was exact before slivers had a pattern of their own.
    #[test]
    fn well_shaped_polygons_are_grids_and_similar_triangles() {
        let triangle = Corners::triangle([DVec3::ZERO, dvec3(3.0, 0.0, 0.0), dvec3(0.0, 1.0, 0.0)]);
        assert_eq!(count(&triangle, 0.5), 49, "√10 m in 7 pieces");
        let quad = Corners::quad([
            DVec3::ZERO,
            dvec3(20.0, 0.0, 0.0),
            dvec3(20.0, 0.05, 0.0),
            dvec3(0.0, 0.05, 0.0),
        ]);
        assert_eq!(count(&quad, 0.05), 400);
        let needle = Corners::triangle([DVec3::ZERO, dvec3(20.0, 0.0, 0.0), dvec3(20.0, 0.05, 0.0)]);
        assert_eq!(count(&needle, 0.05), 401, "20 m and a hair in rows of 5 cm");
        assert!(count(&needle, 1e-30) > 1 << 100, "what is far too fine is counted, too");
    }
}
