//! Cuts a surface into cells along other surfaces in its plane, and determines which sides of each cell are visible.
//!
//! All corners are in the coordinates of the surface's part.

use crate::geometry::aabb::Aabb;
use crate::geometry::polygon::{Clipped, Polygon, clip, quads_and_triangles};
use equilux_formats::{Corners, Part, Surface};
use glam::DVec3;
use std::ops::{Add, Mul};

/// One side of a convex polygon; corners run counter-clockwise as seen from that side.
#[derive(Debug, Clone)]
pub(super) struct Facing {
    /// Its corners, metres.
    pub corners: Vec<DVec3>,
    /// The unit normal of the side.
    pub normal: DVec3,
    /// Whether light may fall on the other side of the surface, too.
    pub two_sided: bool,
}

impl Facing {
    /// The sides of `surface` on which light may fall, front first.
    pub(super) fn sides(part: &Part, surface: &Surface) -> impl Iterator<Item = Self> {
        let two_sided = part.is_two_sided(surface);
        let back = two_sided.then(|| Self::of(&surface.corners.flipped(), two_sided));
        std::iter::once(Self::of(&surface.corners, two_sided)).chain(back)
    }

    /// The side from which `corners` run counter-clockwise.
    fn of(corners: &Corners, two_sided: bool) -> Self {
        let normal = corners.double_area_vector().normalize();
        Self { corners: corners.as_slice().to_vec(), normal, two_sided }
    }

    /// The box around it.
    pub(super) fn bounds(&self) -> Aabb {
        Aabb::around(&self.corners)
    }

    /// Whether two sides lie in one plane, face the same way, and overlap by more than `tolerance`, metres.
    pub(super) fn overlaps(&self, other: &Self, tolerance: f64) -> bool {
        let [small, large] = if self.reach() < other.reach() { [self, other] } else { [other, self] };
        let height = |p: &DVec3| large.normal.dot(*p - large.corners[0]).abs();
        self.normal.dot(other.normal) > 0.0
            && small.corners.iter().all(|p| height(p) <= tolerance)
            && !large.common(&small.corners, tolerance).is_empty()
    }

    fn reach(&self) -> f64 {
        self.corners.iter().map(|&p| (p - self.corners[0]).length_squared()).fold(0.0, f64::max)
    }

    /// For each edge, the distance of a point on its inner side.
    fn edges(&self) -> impl Iterator<Item = impl Fn(DVec3) -> f64> + '_ {
        let next = |i: usize| self.corners[(i + 1) % self.corners.len()];
        self.corners.iter().enumerate().map(move |(i, &from)| {
            let inwards = self.normal.cross(next(i) - from).normalize_or_zero();
            move |p: DVec3| inwards.dot(p - from)
        })
    }

    /// The part of `polygon` that lies inside the edges by more than `depth`.
    fn common(&self, polygon: &[DVec3], depth: f64) -> Polygon {
        let mut rest = Polygon::from_slice(polygon);
        for edge in self.edges() {
            match clip(&rest, |p| edge(p) - depth) {
                Clipped::All => {}
                Clipped::None => return Polygon::new(),
                Clipped::Piece(piece) => rest = piece,
            }
        }
        rest
    }
}

/// A convex piece of a surface, and which of its sides are visible.
#[derive(Debug, Clone)]
struct Cell {
    corners: Polygon,
    front: bool,
    back: bool,
}

/// The visible pieces of `surface` of `part` under `covers`. Pieces narrower than `tolerance`, metres, are dropped.
pub(super) fn seen_pieces(part: &Part, surface: &Surface, covers: &[Facing], tolerance: f64) -> Vec<Surface> {
    let back = part.is_two_sided(surface);
    let own = Facing::of(&surface.corners, back);
    let mut cells = vec![Cell { corners: own.corners.iter().copied().collect(), front: true, back }];
    for cover in covers {
        let on_front = cover.normal.dot(own.normal) > 0.0;
        cells = cells.into_iter().flat_map(|cell| cell.under(cover, on_front, tolerance)).collect();
    }
    let is_wide = |cell: &Cell| width(&cell.corners, own.normal) > tolerance;
    let seen = cells.iter().filter(|cell| (cell.front || cell.back) && is_wide(cell));
    seen.flat_map(|cell| cell.surfaces(surface)).collect()
}

impl Cell {
    /// The cell divided along a cover, with the covered side of the covered piece hidden.
    fn under(self, cover: &Facing, on_front: bool, tolerance: f64) -> Vec<Self> {
        let hides = if on_front { self.front } else { self.back };
        if !hides || cover.common(&self.corners, tolerance).is_empty() {
            return vec![self];
        }
        let (front, back) = (self.front, self.back);
        let (mut cells, mut rest) = (Vec::new(), self.corners);
        for edge in cover.edges() {
            if let Clipped::Piece(corners) = clip(&rest, |p| -edge(p)) {
                cells.push(Self { corners, front, back });
                match clip(&rest, edge) {
                    Clipped::Piece(inside) => rest = inside,
                    Clipped::All | Clipped::None => unreachable!("what is cut lies on both sides"),
                }
            }
        }
        cells.push(Self { corners: rest, front: front && !on_front, back: back && on_front });
        cells
    }

    /// The cell as surfaces of three or four corners that are otherwise like `whole`.
    fn surfaces(&self, whole: &Surface) -> Vec<Surface> {
        let pieces = quads_and_triangles(&self.corners).into_iter().map(|corners| Surface {
            lightmap: whole.lightmap.map(|places| mapped(&corners, &whole.corners, places)),
            normals: whole.normals.map(|normals| mapped(&corners, &whole.corners, normals)),
            back_hidden: whole.back_hidden || !(self.front && self.back),
            texels: whole.texels,
            ..Surface::new(corners, whole.material)
        });
        pieces.map(|piece| if self.front { piece } else { piece.flipped() }).collect()
    }
}

/// The values of a piece's corners, by the affine map of those of the whole's first three corners.
fn mapped<T: Copy + Add<Output = T> + Mul<f64, Output = T>>(
    piece: &Corners,
    whole: &Corners,
    values: [T; 4],
) -> [T; 4] {
    let [a, b, c] = std::array::from_fn(|i| whole.as_slice()[i]);
    let across = (b - a).cross(c - a);
    let share = |u: DVec3, v: DVec3| u.cross(v).dot(across) / across.length_squared();
    let value = |p: DVec3| {
        let (second, third) = (share(p - a, c - a), share(b - a, p - a));
        values[0] * (1.0 - second - third) + values[1] * second + values[2] * third
    };
    let corners = piece.as_slice();
    std::array::from_fn(|i| value(corners[i.min(corners.len() - 1)]))
}

/// Approximate smallest width of a polygon: its area over its longest edge.
fn width(corners: &[DVec3], normal: DVec3) -> f64 {
    let from = corners[0];
    let double_area: DVec3 = corners.windows(2).skip(1).map(|e| (e[0] - from).cross(e[1] - from)).sum();
    let edges = corners.iter().zip(corners.iter().cycle().skip(1)).map(|(a, b)| (*b - *a).length());
    double_area.dot(normal) / 2.0 / edges.fold(0.0, f64::max)
}
