//! The proved error and the power balance of one group.

use crate::exchange::energy::Energy;
use equilux_formats::Rgb;

/// A residual this small, relative to the brightest radiosity, is rounding.
const ROUNDING_RESIDUAL: f64 = 4.0 * f64::EPSILON;

/// Error and power balance of a group at some point of the exchange.
#[derive(Debug, Clone, Copy)]
pub struct ErrorEstimate {
    /// Largest residual, W/m².
    pub residual: Rgb,
    /// Upper bound on the distance of any radiosity from the solution, W/m², channel by channel.
    pub error_bound: Rgb,
    /// The group's brightest radiosity, W/m².
    pub brightest: Rgb,
    /// Power balance, W.
    pub energy: Energy,
}

impl ErrorEstimate {
    /// The bound relative to the brightest radiosity, in the worst channel. Channels are independent equations.
    pub fn relative_bound(&self) -> f64 {
        let of = |c: usize| match self.error_bound[c] {
            0.0 => 0.0,
            bound => bound / self.brightest[c],
        };
        (0..3).map(of).fold(0.0, f64::max)
    }

    /// Whether the residual is no more than rounding in every channel.
    pub fn is_rounded(&self) -> bool {
        (0..3).all(|c| self.residual[c] <= ROUNDING_RESIDUAL * self.brightest[c])
    }

    /// Whether the relative bound is at most `error`.
    pub fn is_within(&self, error: f64) -> bool {
        self.relative_bound() <= error
    }
}
