//! How exactly a block is computed.

use equilux_formats::Precision;

/// How a block is computed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Resolution {
    /// A cluster is taken as a whole if its form factor (at most) × its radius over its distance is below this. 0 takes
    /// elements only: the exact matrix.
    pub opening: f64,
    /// How the numbers are kept.
    pub precision: Precision,
}

/// Every element on its own, every number in full.
pub const EXACT: Resolution = Resolution { opening: 0.0, precision: Precision::Full };

impl Resolution {
    /// The resolution at which radiosity errs by about `tolerance`, relative to its mean, in furnished rooms; the proof
    /// is the bound of the exchange, not this. 0 is exact.
    pub fn for_tolerance(tolerance: f64) -> Self {
        if tolerance == 0.0 {
            EXACT
        } else {
            Self { opening: OPENING * tolerance, precision: Precision::Single }
        }
    }
}

/// What a row whose entries stand for clusters may miss of all it sees, at most: a search ends when a tenth of this is missing,
/// and the rest is for rounding.
pub const MISSED: f64 = 1e-5;

/// Opening per tolerance, found by measuring.
const OPENING: f64 = 0.1;

impl std::fmt::Display for Resolution {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        if *self == EXACT {
            write!(f, "exact")
        } else {
            write!(f, "clusters up to {:e}, {:?}", self.opening, self.precision)
        }
    }
}
