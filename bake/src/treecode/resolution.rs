//! The resolution of a block.

use equilux_formats::rows::Precision;

/// The accuracy of a block.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Resolution {
    /// A cluster gets one entry if (an upper bound of its form factor) × radius / distance is below this. 0 allows
    /// elements only: the exact matrix.
    pub opening: f64,
    /// The precision of stored form factors.
    pub precision: Precision,
    /// Rays a row, if the rows between unknowns are counted rays instead of exact form factors to elements and clusters.
    pub rays: Option<u32>,
}

/// Every element separately, in full precision.
pub const EXACT: Resolution = Resolution { opening: 0.0, precision: Precision::Full, rays: None };

impl Resolution {
    /// The resolution at which the error of radiosity is about `tolerance`, relative to its mean, in furnished rooms.
    /// It is an estimate; the error bound of the exchange is the proof. 0 is exact.
    pub fn for_tolerance(tolerance: f64) -> Self {
        if tolerance == 0.0 {
            EXACT
        } else {
            Self { opening: OPENING * tolerance, precision: Precision::Single, rays: None }
        }
    }
}

/// The number of rays a row at which their noise is about `tolerance` of the mean light: by experience 4 % at 64 rays, and
/// falling with their square root or faster. A power of two, which low-discrepancy points need.
pub fn rays_for_tolerance(tolerance: f64) -> u32 {
    match tolerance {
        t if t >= 0.03 => 64,
        t if t >= 0.01 => 256,
        t if t >= 0.003 => 1024,
        _ => 4096,
    }
}

/// Upper bound of what the sum of a row with entries for clusters may lack: a search ends when a tenth of this is
/// missing, and the rest covers rounding.
pub const MISSED: f64 = 1e-5;

/// Opening per tolerance, measured.
const OPENING: f64 = 0.1;

impl std::fmt::Display for Resolution {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        if let Some(rays) = self.rays {
            write!(f, "{rays} rays a row")
        } else if *self == EXACT {
            write!(f, "exact")
        } else {
            write!(f, "clusters up to {:e}, {:?}", self.opening, self.precision)
        }
    }
}
