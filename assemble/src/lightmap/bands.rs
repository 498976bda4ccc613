//! Divides rectangles of texels into bands of rows.

use std::ops::Range;

/// Approximate number of texels that a thread processes at a time.
const BAND_TEXELS: u32 = 16384;

/// The rows of a rectangle in bands, each of which fits in memory with its footprints.
pub fn bands([width, height]: [u32; 2]) -> impl Iterator<Item = Range<u32>> {
    let rows = (BAND_TEXELS / width).max(1);
    (0..height.div_ceil(rows)).map(move |band| band * rows..(band * rows + rows).min(height))
}
