//! Placements rounded so that equal placements compare equal.

use glam::DAffine3;

/// Step of rounded placements, in powers of two below their largest number: coarse enough to absorb rounding.
const FINE: i32 = 40;

/// A placement in steps of 2^`exponent`, column by column.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct RoundedPlacement {
    /// Its twelve numbers, in steps.
    pub steps: [i64; 12],
    /// Of two; the size of a step.
    pub exponent: i32,
}

impl From<DAffine3> for RoundedPlacement {
    fn from(placement: DAffine3) -> Self {
        let numbers = placement.to_cols_array();
        let most = numbers.iter().fold(f64::MIN_POSITIVE, |most: f64, n| most.max(n.abs()));
        let exponent = most.log2().ceil() as i32 - FINE;
        Self { steps: numbers.map(|n| (n / 2f64.powi(exponent)).round() as i64), exponent }
    }
}

impl From<RoundedPlacement> for DAffine3 {
    fn from(RoundedPlacement { steps, exponent }: RoundedPlacement) -> Self {
        Self::from_cols_array(&steps.map(|step| step as f64 * 2f64.powi(exponent)))
    }
}
