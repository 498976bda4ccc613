//! The proved error and the energy account of one group's light.

use crate::exchange::energy::Energy;
use equilux_formats::Rgb;

/// A residual this small, relative to the brightest radiosity, is the rounding of what it was computed from.
const ROUNDED: f64 = 4.0 * f64::EPSILON;

/// What is known of a group's light at some time.
#[derive(Debug, Clone, Copy)]
pub struct ErrorEstimate {
    /// Largest residual, W/m².
    pub residual: Rgb,
    /// No radiosity is further than this from the solution, W/m², channel by channel.
    pub error_bound: Rgb,
    /// The group's brightest radiosity, W/m².
    pub brightest: Rgb,
    /// Where the power is.
    pub energy: Energy,
}

impl ErrorEstimate {
    /// The bound over the brightest radiosity, of the worst channel: channels are equations of their own.
    pub fn relative_bound(&self) -> f64 {
        let of = |c: usize| match self.error_bound[c] {
            0.0 => 0.0,
            bound => bound / self.brightest[c],
        };
        (0..3).map(of).fold(0.0, f64::max)
    }

    /// Whether what is missing is no more than rounding, in every channel.
    pub fn is_rounded(&self) -> bool {
        (0..3).all(|c| self.residual[c] <= ROUNDED * self.brightest[c])
    }

    pub fn is_within(&self, error: f64) -> bool {
        self.relative_bound() <= error
    }
}
