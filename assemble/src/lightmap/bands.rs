//! Rectangles of texels in bands of rows.

use std::ops::Range;

/// About so many texels are worked on at once by a thread.
const BAND: u32 = 16384;

/// The rows of a rectangle in pieces of which each fits in memory with its footprints.
pub fn bands([width, height]: [u32; 2]) -> impl Iterator<Item = Range<u32>> {
    let rows = (BAND / width).max(1);
    (0..height.div_ceil(rows)).map(move |band| band * rows..(band * rows + rows).min(height))
}
