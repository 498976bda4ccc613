//! The columns of rows of texels and points: what a ray may end on. That is an element, a cell of the sky, or, where the ray is
//! short, a small place on an element, whose own light counts instead of the element's mean.
//!
//! The places on an element are the cells of square grids over it with 2, 4, 8, 16 and 32 cells on a side. The finer the grid,
//! the nearer the start of the ray. A column follows from the number of the element and the place on it, so rows need no list
//! of places.

use crate::gather::sky::SkyCells;
use equilux_bake::geometry::polygon::{Polygon, part};
use equilux_formats::Element;
use glam::{DVec2, DVec3, dvec2};

/// The finest grid has 2 to the power of this many cells on a side, unless columns would not fit in 32 bits.
const LEVELS: u32 = 5;

/// A grid is used up to a distance of the ray of so many of its cells.
const CELLS_AWAY: f64 = 1.0;

/// Numbers of columns.
#[derive(Debug, Clone, Copy)]
pub struct Columns {
    elements: u32,
    levels: u32,
}

/// What a column stands for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Column {
    /// An element of the scene.
    Element(usize),
    /// A cell of the sky.
    Sky(usize),
    /// A place on an element of the scene.
    Place(usize, u32),
}

/// Number of places in grids up to this level, and the element itself.
const fn codes(levels: u32) -> u32 {
    (4u32.pow(levels + 1) - 1) / 3
}

impl Columns {
    /// Columns for this many elements.
    pub fn new(elements: usize) -> Self {
        let fits = |levels: &u32| {
            elements as u64 * u64::from(codes(*levels)) + SkyCells::COUNT as u64 <= u64::from(u32::MAX)
        };
        let levels = (0..=LEVELS).rev().find(fits).unwrap_or(0);
        Self { elements: elements as u32, levels }
    }

    /// Number of columns.
    pub fn count(self) -> usize {
        self.elements as usize * codes(self.levels) as usize + SkyCells::COUNT
    }

    /// The column of an element.
    #[inline(always)]
    pub fn element(self, element: usize) -> u32 {
        element as u32 * codes(self.levels)
    }

    /// The column of a cell of the sky.
    #[inline(always)]
    pub fn sky(self, cell: usize) -> u32 {
        self.elements * codes(self.levels) + cell as u32
    }

    /// The column of the place on an element where a ray ends that is `distance` long; all in one coordinate system. Places are
    /// not smaller than `least`.
    pub fn place(self, number: usize, element: &Element, point: DVec3, [distance, least]: [f64; 2]) -> u32 {
        let frame = Frame::of(element);
        let wide = (distance / CELLS_AWAY).max(least).max(f64::MIN_POSITIVE);
        let cells = frame.extent.max_element() / wide;
        let level = (cells.log2().ceil().clamp(0.0, f64::from(self.levels))) as u32;
        let side = 1u32 << level;
        let [i, j] =
            (frame.at(point) * f64::from(side)).to_array().map(|x| (x.max(0.0) as u32).min(side - 1));
        let first = if level == 0 { 0 } else { codes(level - 1) };
        self.element(number) + first + j * side + i
    }

    /// What a column stands for.
    pub fn meaning(self, column: usize) -> Column {
        let codes = codes(self.levels) as usize;
        match (column / codes, column % codes) {
            _ if column >= self.elements as usize * codes => {
                Column::Sky(column - self.elements as usize * codes)
            }
            (element, 0) => Column::Element(element),
            (element, code) => Column::Place(element, code as u32),
        }
    }
}

/// The polygon of a place on an element; none if it lies beside it.
pub fn polygon(element: &Element, code: u32) -> Option<Polygon> {
    let level = (1..=LEVELS).find(|&level| code < codes(level))?;
    let (first, side) = (codes(level - 1), 1u32 << level);
    let cell = dvec2(f64::from((code - first) % side), f64::from((code - first) / side));
    let [low, high] = [cell, cell + 1.0].map(|corner| corner / f64::from(side));
    let frame = Frame::of(element);
    let mut rest: Polygon = element.corners.as_slice().iter().copied().collect();
    for axis in 0..2 {
        for (sign, bound) in [(1.0, low[axis]), (-1.0, high[axis])] {
            let [inside, _] = part(&rest, |p| sign * (frame.at(p)[axis] - bound));
            rest = inside?;
        }
    }
    Some(rest)
}

/// The rectangle around an element, along its first edge.
struct Frame {
    origin: DVec3,
    axes: [DVec3; 2],
    /// Metres.
    extent: DVec2,
}

impl Frame {
    fn of(element: &Element) -> Self {
        let corners = element.corners.as_slice();
        let along = (corners[1] - corners[0]).normalize_or_zero();
        let axes = [along, element.normal.cross(along)];
        let flat = |p: &DVec3| dvec2((*p - corners[0]).dot(axes[0]), (*p - corners[0]).dot(axes[1]));
        let low = corners.iter().map(flat).fold(DVec2::INFINITY, DVec2::min);
        let high = corners.iter().map(flat).fold(DVec2::NEG_INFINITY, DVec2::max);
        Self { origin: corners[0] + axes[0] * low.x + axes[1] * low.y, axes, extent: high - low }
    }

    /// Coordinates of a point, 0..1 in the rectangle.
    fn at(&self, point: DVec3) -> DVec2 {
        let from = point - self.origin;
        dvec2(from.dot(self.axes[0]), from.dot(self.axes[1])) / self.extent
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use equilux_formats::{Corners, FaceId, MaterialId};
    use proptest::prelude::*;

    proptest! {
        /// The column of a ray's end is a place that contains the end, and is no larger than half the ray, or a 32nd of the element.
        #[test]
        fn a_place_is_small_and_around_the_end(
            (u, v, slant) in (0.001..0.999_f64, 0.001..0.999_f64, -0.5..0.5_f64),
            (distance, is_triangle) in (0.001..0.9_f64, any::<bool>()),
        ) {
            let [a, b, d] = [DVec3::ZERO, DVec3::X, dvec2(slant, 0.8).extend(0.0)];
            let corners = if is_triangle { Corners::triangle([a, b, d]) } else { Corners::quad([a, b, b + d, d]) };
            let element = Element::new(corners, MaterialId(0), FaceId(0));
            let (u, v) = if is_triangle && u + v > 1.0 { (1.0 - u, 1.0 - v) } else { (u, v) };
            let point = b * u + d * v;
            let columns = Columns::new(7);
            let Column::Place(3, code) = columns.meaning(columns.place(3, &element, point, [distance, 0.0]) as usize) else {
                panic!("a place on element 3");
            };
            let place = polygon(&element, code).expect("it has an area");
            let extent = Frame::of(&element).extent.max_element();
            let most = (distance / CELLS_AWAY).max(extent / 32.0) * (1.0 + 1e-9);
            for axis in 0..2 {
                let along = place.iter().map(|p| p[axis]);
                let (low, high) = along.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), x| (l.min(x), h.max(x)));
                prop_assert!(low - 1e-9 <= point[axis] && point[axis] <= high + 1e-9, "{low} {high} {point}");
                // The rectangle of a slanted element is wider along the first edge; its axes are those of the coordinates.
                prop_assert!(high - low <= most, "{} wide, ray of {distance}", high - low);
            }
        }
    }

    #[test]
    fn columns_fit_in_32_bits_and_are_distinct() {
        for elements in [0, 1, 100_000, 10_000_000, 3_000_000_000] {
            let columns = Columns::new(elements);
            assert!(columns.count() <= u32::MAX as usize, "{elements} elements");
            for number in [0, elements / 2, elements.saturating_sub(1)].into_iter().filter(|&n| n < elements)
            {
                assert_eq!(columns.meaning(columns.element(number) as usize), Column::Element(number));
            }
            assert_eq!(columns.meaning(columns.sky(5) as usize), Column::Sky(5));
        }
    }
}
