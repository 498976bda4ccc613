//! Rectangles of texels in which light is interpolated. They start as a lattice over a chart and are divided in
//! four. Which texels are corners says how a rectangle was divided, so nothing else needs to be kept.

/// A rectangle of texels, both corners included.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Square {
    /// The lowest column and row.
    pub low: [u32; 2],
    /// The highest column and row.
    pub high: [u32; 2],
}

/// Most texels on a side of the lattice.
const SIDE: u32 = 32;

impl Square {
    /// The lattice over a rectangle of texels.
    pub fn lattice(low: [u32; 2], high: [u32; 2]) -> Vec<Self> {
        let extent = [0, 1].map(|axis| high[axis] - low[axis]);
        let lines = [0, 1].map(|axis| {
            let count = extent[axis].div_ceil(SIDE).max(1);
            let line =
                move |k: u32| low[axis] + (u64::from(k) * u64::from(extent[axis]) / u64::from(count)) as u32;
            (0..count).map(move |k| [line(k), line(k + 1)])
        });
        let [columns, rows] = lines;
        let row =
            |[y0, y1]: [u32; 2]| columns.clone().map(move |[x0, x1]| Self { low: [x0, y0], high: [x1, y1] });
        rows.flat_map(row).collect()
    }

    /// Number of steps from texel to texel on each side.
    pub fn steps(self) -> [u32; 2] {
        [0, 1].map(|axis| self.high[axis] - self.low[axis])
    }

    /// Whether it has no texels but its corners.
    pub fn is_smallest(self) -> bool {
        self.steps().into_iter().all(|steps| steps <= 1)
    }

    /// The texel at which its parts meet.
    pub fn centre(self) -> [u32; 2] {
        [0, 1].map(|axis| self.low[axis].midpoint(self.high[axis]))
    }

    /// All its texels.
    pub fn texels(self) -> impl Iterator<Item = [u32; 2]> {
        (self.low[1]..=self.high[1]).flat_map(move |y| (self.low[0]..=self.high[0]).map(move |x| [x, y]))
    }

    /// Its two or four parts, which share the texels between them.
    pub fn parts(self) -> impl Iterator<Item = Self> {
        let middle = self.centre();
        let halves = [0, 1].map(|axis| {
            let (low, high) = (self.low[axis], self.high[axis]);
            if high - low <= 1 { vec![[low, high]] } else { vec![[low, middle[axis]], [middle[axis], high]] }
        });
        let [columns, rows] = halves;
        rows.into_iter().flat_map(move |[y0, y1]| {
            let parts = columns.clone().into_iter();
            parts.map(move |[x0, x1]| Self { low: [x0, y0], high: [x1, y1] })
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        /// Wherever a rectangle is divided, texels on common edges are corners, or lie on the same line between the same corners.
        #[test]
        fn parts_cover_a_rectangle_and_share_their_edges(width in 0u32..200, height in 0u32..200, deep in 0usize..6) {
            let mut seen = vec![0u32; ((width + 1) * (height + 1)) as usize];
            let mut squares = Square::lattice([3, 5], [3 + width, 5 + height]);
            for _ in 0..deep {
                squares = squares.into_iter().flat_map(|square| {
                    if square.is_smallest() { vec![square] } else { square.parts().collect() }
                }).collect();
            }
            for [x, y] in squares.iter().flat_map(|square| square.texels()) {
                seen[((y - 5) * (width + 1) + x - 3) as usize] += 1;
            }
            prop_assert!(seen.iter().all(|count| (1..=4).contains(count)));
        }
    }
}
