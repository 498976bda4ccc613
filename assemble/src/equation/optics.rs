//! Optics of all elements of a scene.

use crate::placed_parts::PlacedParts;
use equilux_formats::Optics;

/// Optics of all elements, instance after instance.
pub fn whole_optics(placed: &PlacedParts) -> Optics {
    joined(&(0..placed.instances.len()).map(|k| placed.optics_of(k)).collect::<Vec<_>>())
}

/// Optics of several instances, one after the other.
pub fn joined(each: &[Optics]) -> Optics {
    Optics {
        reflectance: each.iter().flat_map(|o| o.reflectance.iter().copied()).collect(),
        emission: each.iter().flat_map(|o| o.emission.iter().copied()).collect(),
    }
}
