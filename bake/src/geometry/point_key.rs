//! Points and edges as keys of maps; keys are equal if the points are bit-identical.

use glam::DVec3;

/// A point as a key.
pub(crate) type PointKey = [u64; 3];

/// The key of a point. Adding 0 makes −0 and 0 one key.
pub(crate) fn point_key(p: DVec3) -> PointKey {
    (p + 0.0).to_array().map(f64::to_bits)
}

/// The keys of an edge's ends, the smaller one first.
pub(crate) type EdgeKey = [PointKey; 2];

/// The edges around a polygon: the key of each, whichever way it runs, and whether it runs from the smaller key to the
/// larger.
pub(crate) fn edge_keys(corners: &[DVec3]) -> impl Iterator<Item = (EdgeKey, bool)> + '_ {
    let key = |i: usize| point_key(corners[i % corners.len()]);
    (0..corners.len()).map(move |i| {
        let (a, b) = (key(i), key(i + 1));
        if a < b { ([a, b], true) } else { ([b, a], false) }
    })
}
