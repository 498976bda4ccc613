//! The number of shadow rays.

/// How many shadow rays a form factor takes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Effort {
    /// Rays to the source that sends an unknown the most: at first, and in all where they do not agree.
    pub(super) most: [f64; 2],
    /// Rays to sources that send it little.
    pub(super) fewest: [f64; 2],
}

impl Effort {
    /// For emitting surfaces.
    pub const DIRECT: Self = Self { most: [64.0, 256.0], fewest: [4.0, 16.0] };
    /// For suns, which cast sharp shadows.
    pub const SUN: Self = Self { most: [64.0, 64.0], fewest: [64.0, 64.0] };
    /// For what is reflected, which is weaker and has more sources.
    pub const REFLECTED: Self = Self { most: [16.0, 32.0], fewest: [2.0, 2.0] };
    /// For texels: shadows may end anywhere on them.
    pub const TEXELS: Self = Self { most: [32.0, 128.0], fewest: [8.0, 16.0] };
    /// For small places, of which a receiver sees many.
    pub const PLACES: Self = Self { most: [8.0, 32.0], fewest: [8.0, 8.0] };
}
