//! Which element of one side of a face lies at a place: a grid of cells, each with the elements that overlap it.

use equilux_formats::Element;
use glam::DVec3;

/// The elements of one side of a face.
#[derive(Debug)]
pub struct ElementGrid {
    origin: DVec3,
    /// Per metre along the face: cells in each direction.
    axes: [DVec3; 2],
    cells: [usize; 2],
    /// Where the elements of each cell start.
    starts: Vec<u32>,
    /// Elements, by cell.
    inside: Vec<u32>,
    /// Whether the elements cover the whole face.
    is_full: bool,
}

/// A place this far outside of an element, relative to the face, still belongs to it: edges are rounded.
const OUTSIDE: f64 = 1e-6;

impl ElementGrid {
    /// A grid over these elements of a face of this area (m²). `elements`: all of the part.
    pub fn new(own: &[u32], elements: &[Element], area: f64) -> Self {
        let first = &elements[own[0] as usize];
        let corners = first.corners.as_slice();
        let u = (corners[1] - corners[0]).normalize();
        let v = first.normal.cross(u);
        let origin = corners[0];
        let flat = |p: DVec3| [(p - origin).dot(u), (p - origin).dot(v)];
        let extents: Vec<[[f64; 2]; 2]> = own.iter().map(|&e| extent(&elements[e as usize], flat)).collect();
        let all = extents.iter().copied().reduce(|a, b| {
            [[a[0][0].min(b[0][0]), a[0][1].min(b[0][1])], [a[1][0].max(b[1][0]), a[1][1].max(b[1][1])]]
        });
        let [low, high] = all.expect("a side has elements");
        // About as many cells as elements, as wide as an element is on average.
        let mean = |k: usize| extents.iter().map(|e| e[1][k] - e[0][k]).sum::<f64>() / own.len() as f64;
        let cells = [0, 1].map(|k| (((high[k] - low[k]) / mean(k)).round() as usize).clamp(1, 4 * own.len()));
        let scale = [0, 1].map(|k| cells[k] as f64 / (high[k] - low[k]));
        let range = |extent: &[[f64; 2]; 2], k: usize| {
            // An edge on a grid line, give or take rounding, does not reach into the next cell.
            let cell = |x: f64| (x.max(0.0) as usize).min(cells[k] - 1);
            let at = |x: f64| (x - low[k]) * scale[k];
            let (from, to) = (at(extent[0][k]) + OUTSIDE, at(extent[1][k]) - OUTSIDE);
            cell(from)..=cell(to.max(from))
        };
        let mut by_cell: Vec<Vec<u32>> = vec![vec![]; cells[0] * cells[1]];
        for (&element, extent) in own.iter().zip(&extents) {
            for j in range(extent, 1) {
                range(extent, 0).for_each(|i| by_cell[j * cells[0] + i].push(element));
            }
        }
        let mut starts = vec![0];
        starts.extend(by_cell.iter().scan(0, |sum, cell| {
            *sum += cell.len() as u32;
            Some(*sum)
        }));
        Self {
            origin: origin + u * low[0] + v * low[1],
            axes: [u * scale[0], v * scale[1]],
            cells,
            starts,
            inside: by_cell.concat(),
            is_full: own.iter().map(|&e| elements[e as usize].area).sum::<f64>() >= area * (1.0 - OUTSIDE),
        }
    }

    /// The element at a place on the face: of those near it the one whose edges it lies furthest within. None if this side has
    /// no element there.
    #[inline(always)]
    pub fn at(&self, place: DVec3, elements: &[Element]) -> Option<u32> {
        let from = place - self.origin;
        let cell = |k: usize| (from.dot(self.axes[k]).max(0.0) as usize).min(self.cells[k] - 1);
        let number = cell(1) * self.cells[0] + cell(0);
        let near = &self.inside[self.starts[number] as usize..self.starts[number + 1] as usize];
        match *near {
            [only] if self.is_full => Some(only),
            [] if self.is_full => self.deepest(&self.inside, place, elements),
            _ => self.deepest(near, place, elements),
        }
    }

    #[inline(never)]
    fn deepest(&self, among: &[u32], place: DVec3, elements: &[Element]) -> Option<u32> {
        let depths = among.iter().map(|&e| (depth(&elements[e as usize], place), e));
        let (depth, element) = depths.reduce(|best, next| if next.0 > best.0 { next } else { best })?;
        let size = elements[element as usize].area.sqrt();
        (self.is_full || depth >= -OUTSIDE * size).then_some(element)
    }
}

/// The corners' extent in the plane: lowest and highest.
fn extent(element: &Element, flat: impl Fn(DVec3) -> [f64; 2]) -> [[f64; 2]; 2] {
    let start = [[f64::INFINITY; 2], [f64::NEG_INFINITY; 2]];
    element.corners.as_slice().iter().fold(start, |[low, high], &corner| {
        let [x, y] = flat(corner);
        [[low[0].min(x), low[1].min(y)], [high[0].max(x), high[1].max(y)]]
    })
}

/// How far a place lies inside the nearest edge of an element, metres; negative outside.
fn depth(element: &Element, place: DVec3) -> f64 {
    let corners = element.corners.as_slice();
    let inside = |i: usize| {
        let (a, b) = (corners[i], corners[(i + 1) % corners.len()]);
        let edge = b - a;
        element.normal.dot(edge.cross(place - a)) / edge.length()
    };
    (0..corners.len()).map(inside).fold(f64::INFINITY, f64::min)
}

#[cfg(test)]
mod tests {
    use super::super::shapes::rotation;
    use super::*;
    use equilux_formats::{Corners, FaceId, MaterialId};
    use proptest::prelude::*;
    use proptest::sample::Index;

    fn element(corners: Corners) -> Element {
        Element::new(corners, MaterialId(0), FaceId(0))
    }

    /// A parallelogram as rows of smaller ones.
    fn rows(u: DVec3, v: DVec3, [columns, rows]: [u32; 2]) -> Vec<Element> {
        let corner =
            |i: u32, j: u32| u * (f64::from(i) / f64::from(columns)) + v * (f64::from(j) / f64::from(rows));
        let cell =
            |i, j| Corners::quad([corner(i, j), corner(i + 1, j), corner(i + 1, j + 1), corner(i, j + 1)]);
        (0..rows).flat_map(|j| (0..columns).map(move |i| (i, j))).map(|(i, j)| element(cell(i, j))).collect()
    }

    /// A triangle in four, and these in four, as often as asked.
    fn triangles(corners: [DVec3; 3], times: u32) -> Vec<Element> {
        if times == 0 {
            return vec![element(Corners::triangle(corners))];
        }
        let [a, b, c] = corners;
        let [ab, bc, ca] = [a.midpoint(b), b.midpoint(c), c.midpoint(a)];
        let inner = [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]];
        inner.into_iter().flat_map(|corners| triangles(corners, times - 1)).collect()
    }

    /// The elements of a face in space, long, slanted or regular.
    fn elements() -> impl Strategy<Value = Vec<Element>> {
        let shape = prop_oneof![
            prop::array::uniform2(1..20_u32).prop_map(|cells| (cells, 0)),
            (1..4_u32).prop_map(|times| ([0, 0], times)),
        ];
        (rotation(), 0.01..10.0_f64, -0.8..0.8_f64, shape).prop_map(|(turn, width, slant, (cells, times))| {
            let [u, v] = [turn * DVec3::X * width, turn * DVec3::new(slant, 1.0, 0.0)];
            if times == 0 { rows(u, v, cells) } else { triangles([DVec3::ZERO, u, v], times) }
        })
    }

    /// A place in an element: its middle, or nearer to a corner.
    fn place(element: &Element, corner: &Index, share: f64) -> DVec3 {
        let corners = element.corners.as_slice();
        element.centroid.lerp(corners[corner.index(corners.len())], share)
    }

    proptest! {
        /// At 0.999 of the way from the middle to a corner a place is still a thousandth of the element away from its edges,
        /// a hundred times more than rounding moves it.
        #[test]
        fn a_place_belongs_to_the_element_around_it_or_to_none(
            (all, kept) in (elements(), prop::collection::vec(prop::bool::weighted(0.8), 400)),
            (of, corner, share) in (any::<Index>(), any::<Index>(), 0.0..0.999_f64),
            is_covered in any::<bool>(),
        ) {
            let kept = |number: u32| is_covered || kept[number as usize];
            let own: Vec<u32> = (0..all.len() as u32).filter(|&number| kept(number)).collect();
            prop_assume!(!own.is_empty());
            let grid = ElementGrid::new(&own, &all, all.iter().map(|element| element.area).sum());
            let element = of.index(all.len());
            let found = grid.at(place(&all[element], &corner, share), &all);
            prop_assert_eq!(found, kept(element as u32).then_some(element as u32));
        }

        /// On a covered face every place belongs to an element that it touches, even at corners and edges.
        #[test]
        fn a_covered_face_has_an_element_everywhere(
            (all, of, corner) in (elements(), any::<Index>(), any::<Index>()),
        ) {
            let own: Vec<u32> = (0..all.len() as u32).collect();
            let grid = ElementGrid::new(&own, &all, all.iter().map(|element| element.area).sum());
            let place = place(&all[of.index(all.len())], &corner, 1.0);
            let found = &all[grid.at(place, &all).expect("the face is covered") as usize];
            let size = found.corners.as_slice().windows(2).map(|edge| (edge[1] - edge[0]).length()).fold(0.0, f64::max);
            prop_assert!(depth(found, place) >= -OUTSIDE * size, "{:?} at {}", found, place);
        }
    }
}
