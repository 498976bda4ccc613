//! The sides of a part's surfaces that light can fall on. In goes a part; out come its surfaces, and once more, seen
//! from behind, those that are double-sided.

use equilux_formats::{Corners, MaterialId, Part, Surface};
use glam::DVec3;

/// A surface seen from the side that is lit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Side {
    /// Corners, counter-clockwise seen from this side, metres.
    pub corners: Corners,
    /// Unit normal of this side.
    pub normal: DVec3,
    /// Area, m².
    pub area: f64,
    /// Its material.
    pub material: MaterialId,
}

impl Side {
    /// The side of `corners` that they run around counter-clockwise. The area must be above zero.
    pub fn new(corners: Corners, material: MaterialId) -> Self {
        let double_area = corners.double_area_vector();
        Self { corners, normal: double_area.normalize(), area: double_area.length() / 2.0, material }
    }
}

/// All sides of `part`, fronts in the order of its surfaces, then backs.
pub fn sides(part: &Part) -> Vec<Side> {
    let front = |s: &Surface| Side::new(s.corners, s.material);
    let back = |s: &Surface| Side::new(s.corners.flipped(), s.material);
    let double = part.surfaces.iter().filter(|s| part.materials[s.material.index()].double_sided);
    part.surfaces.iter().map(front).chain(double.map(back)).collect()
}
