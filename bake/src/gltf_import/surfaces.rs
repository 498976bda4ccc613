//! Turns triangles into clean surfaces: drops faces without area and duplicates, and joins triangles that are halves of
//! a quad, unless their lightmap coordinates differ. The surfaces of a primitive keep the order of its triangles.

use super::triangles::Triangles;
use crate::geometry::point_key::{PointKey, point_key};
use crate::geometry::tolerance::{BENT_QUAD, ROUNDED_CORNERS};
use equilux_formats::texture::TexturedTriangle;
use equilux_formats::{Corners, MaterialId, Surface};
use glam::{DVec2, DVec3};
use std::collections::{HashMap, HashSet};
use std::ops::AddAssign;

/// Smallest sine of a corner of a quad that is no parallelogram; blunter corners lead to needles when the quad is cut.
const BLUNTEST: f64 = 0.1;
/// Tolerance of lightmap coordinates, in widths of the lightmap: a tenth of a texel of 4096, or one and a half steps of
/// 16-bit coordinates.
const LIGHTMAP_STEP: f64 = 2.5e-5;
/// Normals that have at least this cosine with that of the face, of one degree, are those of a flat face: files round them.
const FLAT: f64 = 0.999_85;
/// Triangles considered across one edge; thousands around one edge would otherwise take quadratic time.
const NEIGHBOURS: usize = 16;

/// Counts of dropped faces.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(super) struct Dropped {
    pub(super) without_area: usize,
    pub(super) duplicates: usize,
}

impl AddAssign for Dropped {
    fn add_assign(&mut self, other: Self) {
        self.without_area += other.without_area;
        self.duplicates += other.duplicates;
    }
}

/// The surfaces of a primitive.
pub(super) struct Surfaces {
    /// All of material 0.
    pub(super) kept: Vec<Surface>,
    /// Their source triangles, if colours vary over them.
    pub(super) textured: Vec<TexturedTriangle>,
    pub(super) dropped: Dropped,
    /// The rounding step of the largest coordinate, in the mesh's unit.
    pub(super) step: f64,
}

/// Cleans `triangles` and pairs them.
pub(super) fn surfaces(triangles: &Triangles) -> Surfaces {
    let spacing = if triangles.rounded { f32_spacing } else { f64_spacing };
    let (kept, dropped) = clean(triangles, spacing);
    let step = spacing(kept.iter().map(|kept| largest_coordinate(&kept.corners)).fold(0.0, f64::max));
    let textured = match &triangles.textured {
        Some(textured) => kept.iter().map(|kept| textured[kept.source].clone()).collect(),
        None => Vec::new(),
    };
    Surfaces { kept: pair(&kept, step), textured, dropped, step }
}

/// The distance from `magnitude` to the next f32.
pub(super) fn f32_spacing(magnitude: f64) -> f64 {
    let magnitude = magnitude as f32;
    f64::from(magnitude.next_up()) - f64::from(magnitude)
}

/// The distance from `magnitude` to the next f64.
pub(super) fn f64_spacing(magnitude: f64) -> f64 {
    magnitude.next_up() - magnitude
}

/// Whether a polygon is higher than the rounding of its coordinates, half a `spacing`.
pub(super) fn has_area(corners: &Corners, spacing: fn(f64) -> f64) -> bool {
    let points = corners.as_slice();
    let longest = edges(points).map(DVec3::length).fold(0.0, f64::max);
    corners.double_area_vector().length() > 0.5 * spacing(largest_coordinate(points)) * longest
}

fn edges(points: &[DVec3]) -> impl Iterator<Item = DVec3> {
    points.iter().zip(points.iter().cycle().skip(1)).map(|(from, to)| to - from)
}

fn largest_coordinate(points: &[DVec3]) -> f64 {
    points.iter().map(|point| point.abs().max_element()).fold(0.0, f64::max)
}

/// Gives equal points equal numbers.
#[derive(Default)]
struct Welder(HashMap<PointKey, usize>);

impl Welder {
    fn number(&mut self, point: DVec3) -> usize {
        let next = self.0.len();
        *self.0.entry(point_key(point)).or_insert(next)
    }
}

/// A set of faces, independent of the first corner of each.
#[derive(Default)]
pub(super) struct FaceSet {
    welder: Welder,
    faces: HashSet<[usize; 4]>,
}

impl FaceSet {
    /// Adds a face with these corners and this orientation; returns whether it was not in the set.
    pub(super) fn first_time(&mut self, corners: &Corners) -> bool {
        let points = corners.as_slice();
        let mut key = [usize::MAX; 4];
        for (number, &point) in key.iter_mut().zip(points) {
            *number = self.welder.number(point);
        }
        let numbers = &mut key[..points.len()];
        let first = (0..numbers.len()).min_by_key(|&at| numbers[at]).unwrap_or(0);
        numbers.rotate_left(first);
        self.faces.insert(key)
    }
}

/// A triangle with an area that is no duplicate.
struct CleanTriangle {
    corners: [DVec3; 3],
    /// Their lightmap coordinates.
    lightmap: Option<[DVec2; 3]>,
    /// Their normals, if the mesh is smooth here.
    normals: Option<[DVec3; 3]>,
    /// Its position in the primitive.
    source: usize,
}

fn clean(triangles: &Triangles, spacing: fn(f64) -> f64) -> (Vec<CleanTriangle>, Dropped) {
    let (mut kept, mut dropped, mut seen) = (Vec::new(), Dropped::default(), FaceSet::default());
    for (source, &corners) in triangles.corners.iter().enumerate() {
        let face = Corners::triangle(corners);
        if !has_area(&face, spacing) {
            dropped.without_area += 1;
        } else if !seen.first_time(&face) {
            dropped.duplicates += 1;
        } else {
            let lightmap = triangles.lightmap.as_ref().map(|places| places[source]);
            let normals = triangles.normals.as_ref().and_then(|normals| smooth(&face, normals[source]));
            kept.push(CleanTriangle { corners, lightmap, normals, source });
        }
    }
    (kept, dropped)
}

/// The unit normals of a triangle's corners if they differ from that of the face; none if one is no number, or points behind it.
fn smooth(face: &Corners, normals: [DVec3; 3]) -> Option<[DVec3; 3]> {
    let flat = face.double_area_vector().normalize();
    let normals = normals.map(DVec3::normalize_or_zero);
    let cosines = normals.map(|normal| normal.dot(flat));
    (cosines.iter().all(|&cosine| cosine > 0.0) && cosines.iter().any(|&cosine| cosine < FLAT))
        .then_some(normals)
}

/// Joins the halves of quads. Exporters write the two triangles of a quad one after the other, so consecutive triangles
/// are joined if they form a flat convex quad; the others, lowest index first, only if they form a parallelogram.
fn pair(kept: &[CleanTriangle], step: f64) -> Vec<Surface> {
    let mut quads: Vec<Option<Quad>> = vec![None; kept.len()];
    let mut paired = vec![false; kept.len()];
    for first in 0..kept.len().saturating_sub(1) {
        let halves = [&kept[first], &kept[first + 1]];
        if halves[0].source.is_multiple_of(2) && halves[1].source == halves[0].source + 1 {
            quads[first] =
                halves_of(halves).filter(|quad| is_parallelogram(&quad.0, step) || is_convex(&quad.0, step));
            paired[first..first + 2].fill(quads[first].is_some());
        }
    }
    let neighbours = Neighbours::of(kept, &paired);
    for first in 0..kept.len() {
        if paired[first] {
            continue;
        }
        let others = neighbours.of_triangle(first).filter(|&other| other > first && !paired[other]);
        let fitting = others.filter_map(|other| {
            let quad = halves_of([&kept[first], &kept[other]])?;
            is_parallelogram(&quad.0, step).then_some((other, quad))
        });
        if let Some((second, quad)) = fitting.min_by_key(|(other, _)| *other) {
            quads[first] = Some(quad);
            (paired[first], paired[second]) = (true, true);
        }
    }
    let surface =
        |corners, lightmap, normals| Surface { lightmap, normals, ..Surface::new(corners, MaterialId(0)) };
    let made = |(at, own): (usize, &CleanTriangle)| match quads[at] {
        Some((corners, lightmap, normals)) => Some(surface(Corners::quad(corners), lightmap, normals)),
        None => (!paired[at]).then(|| {
            let repeated = own.lightmap.map(|[a, b, c]| [a, b, c, c]);
            surface(Corners::triangle(own.corners), repeated, own.normals.map(|[a, b, c]| [a, b, c, c]))
        }),
    };
    kept.iter().enumerate().filter_map(made).collect()
}

/// The normals of a quad's corners, from the first of its halves that has the corner; none if both are flat.
fn normals_of(corners: [DVec3; 4], halves: [&CleanTriangle; 2]) -> Option<[DVec3; 4]> {
    halves.iter().any(|half| half.normals.is_some()).then(|| {
        corners.map(|corner| {
            let place = |half: &CleanTriangle| half.corners.iter().position(|&own| own == corner);
            let (half, at) =
                halves.iter().find_map(|half| Some((half, place(half)?))).expect("a half has it");
            half.normals.map_or_else(
                || Corners::triangle(half.corners).double_area_vector().normalize(),
                |normals| normals[at],
            )
        })
    })
}

/// Corners, their lightmap coordinates and their normals.
type Quad = ([DVec3; 4], Option<[DVec2; 4]>, Option<[DVec3; 4]>);

/// The quad that the two triangles are halves of, starting at the first one's first corner.
fn halves_of(halves: [&CleanTriangle; 2]) -> Option<Quad> {
    let [first, second] = halves.map(|half| half.corners);
    for (i, j) in (0..3).flat_map(|i| (0..3).map(move |j| (i, j))) {
        let (from, to, apex) = (first[i], first[(i + 1) % 3], first[(i + 2) % 3]);
        if second[j] == to && second[(j + 1) % 3] == from {
            let mut quad = [from, second[(j + 2) % 3], to, apex];
            let lightmap = match halves.map(|half| half.lightmap) {
                [Some(first), Some(second)] => Some(joined(&quad, first, i, second, j)?),
                [None, None] => None,
                _ => return None,
            };
            quad.rotate_left([0, 3, 2][i]);
            let turned = |mut places: [DVec2; 4]| {
                places.rotate_left([0, 3, 2][i]);
                places
            };
            return Some((quad, lightmap.map(turned), normals_of(quad, halves)));
        }
    }
    None
}

/// The lightmap coordinates of the corners of `quad`, if one affine map gives those of both halves. The halves meet in
/// edge `i` of the first and edge `j` of the second.
fn joined(
    quad: &[DVec3; 4],
    first: [DVec2; 3],
    i: usize,
    second: [DVec2; 3],
    j: usize,
) -> Option<[DVec2; 4]> {
    let places = [first[i], second[(j + 2) % 3], first[(i + 1) % 3], first[(i + 2) % 3]];
    let [from, to, apex] = [quad[0], quad[2], quad[3]];
    // Barycentric coordinates of the second half's own corner in the first half.
    let normal = (to - from).cross(apex - from);
    let share = |p: DVec3, q: DVec3| (p - quad[1]).cross(q - quad[1]).dot(normal) / normal.length_squared();
    let mapped = places[0] * share(to, apex) + places[2] * share(apex, from) + places[3] * share(from, to);
    let near = |p: DVec2, q: DVec2| (p - q).abs().max_element() <= LIGHTMAP_STEP;
    let shared = near(second[j], places[2]) && near(second[(j + 1) % 3], places[0]);
    (shared && near(mapped, places[1])).then_some(places)
}

/// The tolerance of corner positions of a quad.
fn slack(quad: &[DVec3; 4], step: f64) -> f64 {
    let [a, b, c, d] = *quad;
    (ROUNDED_CORNERS * step).min(BENT_QUAD * (c - a).length().max((d - b).length()))
}

fn is_parallelogram(quad: &[DVec3; 4], step: f64) -> bool {
    let [a, b, c, d] = *quad;
    ((a - b) + (c - d)).abs().max_element() <= slack(quad, step)
}

/// Whether the quad is flat and convex, without blunt corners.
fn is_convex(quad: &[DVec3; 4], step: f64) -> bool {
    let [a, b, c, d] = *quad;
    let normal = (c - a).cross(d - b).normalize_or_zero();
    let turns = (0..4).all(|i| {
        let (before, after) = (quad[(i + 1) % 4] - quad[i], quad[(i + 2) % 4] - quad[(i + 1) % 4]);
        before.cross(after).dot(normal) > BLUNTEST * before.length() * after.length()
    });
    turns && (b - a).dot(normal).abs() <= slack(quad, step)
}

/// The triangles across each edge of each triangle.
struct Neighbours {
    corners: Vec<[usize; 3]>,
    by_edge: HashMap<(usize, usize), Vec<usize>>,
}

impl Neighbours {
    /// Neighbours among the triangles that are not `paired` yet.
    fn of(kept: &[CleanTriangle], paired: &[bool]) -> Self {
        let mut welder = Welder::default();
        let corners: Vec<[usize; 3]> =
            kept.iter().map(|kept| kept.corners.map(|corner| welder.number(corner))).collect();
        let mut by_edge: HashMap<_, Vec<usize>> = HashMap::new();
        for triangle in (0..kept.len()).filter(|&triangle| !paired[triangle]) {
            for side in 0..3 {
                let edge = (corners[triangle][side], corners[triangle][(side + 1) % 3]);
                by_edge.entry(edge).or_default().push(triangle);
            }
        }
        Self { corners, by_edge }
    }

    fn of_triangle(&self, triangle: usize) -> impl Iterator<Item = usize> {
        let corners = self.corners[triangle];
        (0..3)
            .filter_map(move |side| self.by_edge.get(&(corners[(side + 1) % 3], corners[side])))
            .flat_map(|across| across.iter().take(NEIGHBOURS).copied())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(corners: Vec<[[f64; 3]; 3]>) -> Surfaces {
        let corners = corners.into_iter().map(|triangle| triangle.map(DVec3::from_array)).collect();
        surfaces(&Triangles {
            corners,
            lightmap: None,
            normals: None,
            textured: None,
            rounded: true,
            left_over: 0,
        })
    }

    const A: [f64; 3] = [0.0, 0.0, 0.0];
    const B: [f64; 3] = [2.0, 0.0, 0.0];
    const C: [f64; 3] = [3.0, 1.0, 0.0];
    const D: [f64; 3] = [1.0, 1.0, 0.0];

    /// Each way of cutting and writing a parallelogram gives back its outline, from its first triangle's first corner.
    #[test]
    fn halves_of_a_parallelogram_become_one_quad() {
        let rotated = |[p, q, r]: [[f64; 3]; 3], by: usize| {
            let mut corners = [p, q, r];
            corners.rotate_left(by);
            corners
        };
        for halves in [[[A, B, C], [A, C, D]], [[A, B, D], [B, C, D]]] {
            for (i, j) in (0..3).flat_map(|i| (0..3).map(move |j| (i, j))) {
                let [first, second] = [rotated(halves[0], i), rotated(halves[1], j)];
                let quads = of(vec![first, second]).kept;
                let mut outline = [A, B, C, D];
                let start =
                    outline.iter().position(|&corner| corner == first[0]).expect("a corner of the outline");
                outline.rotate_left(start);
                assert_eq!(
                    quads,
                    [Surface::new(Corners::quad(outline.map(DVec3::from_array)), MaterialId(0))],
                    "{first:?} with {second:?}"
                );
            }
        }
    }

    #[test]
    fn what_is_no_quad_stays_triangles() {
        let (bent, askew, blunt) = ([1.0, 1.0, 0.01], [1.0, 1.5, 0.0], [1.5, 0.52, 0.0]);
        let far = [[9.0, 0.0, 0.0], [9.0, 1.0, 0.0], [9.0, 0.0, 1.0]];
        for (case, triangles, count) in [
            ("a modelled quad", vec![[A, B, C], [A, C, askew]], 1),
            ("bent", vec![[A, B, C], [A, C, bent]], 2),
            ("almost a triangle", vec![[A, B, C], [A, C, blunt]], 2),
            ("turned over", vec![[A, B, C], [A, D, C]], 2),
            ("neighbours, not written as a pair", vec![far, [A, B, C], [A, C, askew]], 3),
        ] {
            assert_eq!(of(triangles).kept.len(), count, "{case}");
        }
    }

    /// A strip of three squares whose triangles are written in pairs, but shifted by a lone triangle, and out of order.
    #[test]
    fn each_triangle_pairs_at_most_once_and_none_is_lost() {
        let square = |x: f64| {
            let [a, b, c, d] = [[x, 0.0, 0.0], [x + 1.0, 0.0, 0.0], [x + 1.0, 1.0, 0.0], [x, 1.0, 0.0]];
            [[a, b, c], [a, c, d]]
        };
        let lone = [[9.0, 0.0, 0.0], [10.0, 0.0, 0.0], [9.0, 3.0, 0.0]];
        let ([a, b], [c, d], [e, f]) = (square(0.0), square(1.0), square(2.0));
        for triangles in [vec![lone, a, b, c, d, e, f], vec![a, c, e, lone, f, d, b]] {
            let surfaces = of(triangles).kept;
            let area: f64 = surfaces.iter().map(|s| s.corners.double_area_vector().length() / 2.0).sum();
            assert!(surfaces.len() < 7, "none of seven triangles found its partner");
            assert!((area - 4.5).abs() < 1e-12, "area {area}, expected 3 squares and a triangle of 1.5");
        }
    }

    /// One affine map, another turn of the second half, and another place of it.
    #[test]
    fn halves_that_lie_otherwise_in_a_lightmap_stay_triangles() {
        let place = |[x, y, _]: [f64; 3]| DVec2::new(0.2 + 0.1 * x, 0.3 + 0.05 * y - 0.02 * x);
        let [first, second] = [[A, B, C].map(place), [A, C, D].map(place)];
        for (case, second, count) in [
            ("one map", second, 1),
            ("the far corner elsewhere", [second[0], second[1], second[2] + 0.01], 2),
            ("all elsewhere", second.map(|place| place + 0.3), 2),
        ] {
            let corners = [[A, B, C], [A, C, D]].map(|triangle| triangle.map(DVec3::from_array)).to_vec();
            let triangles = Triangles {
                corners,
                lightmap: Some(vec![first, second]),
                normals: None,
                textured: None,
                rounded: true,
                left_over: 0,
            };
            let kept = surfaces(&triangles).kept;
            assert_eq!(kept.len(), count, "{case}");
            let found = kept[0].lightmap.expect("a place in the lightmap");
            let expected = if count == 1 { [A, B, C, D].map(place) } else { [A, B, C, C].map(place) };
            assert_eq!(found, expected, "{case}");
        }
    }

    #[test]
    fn flat_and_repeated_faces_are_dropped_and_counted() {
        let tenths = [[0.1_f32, 0.2, 0.3], [0.2, 0.4, 0.6], [0.7, 1.4, 2.1]].map(|p| p.map(f64::from));
        let surfaces = of(vec![[A, B, C], [A, A, B], tenths, [B, C, A], [A, C, B]]);
        assert_eq!(surfaces.kept.len(), 2, "a face and the same turned over");
        assert_eq!(surfaces.dropped, Dropped { without_area: 2, duplicates: 1 });
    }

    #[test]
    fn the_step_is_that_of_f32_at_the_largest_coordinate() {
        let at = |x: f64| of(vec![[A, B, D].map(|[p, q, r]| [p + x, q, r])]).step;
        assert_eq!(at(2e4), 2.0_f64.powi(-9));
    }
}
