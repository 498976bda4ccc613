//! Converts light to display values. Input: radiosity. Output: linear RGB in 0..1.
//!
//! The displayed radiance is L = B/π. After exposure, x = k·L, each channel is mapped by t(x) = x up to the knee s =
//! 0.8 and t(x) = 1 − (1 − s)·exp(−(x − s)/(1 − s)) above: one smooth curve that leaves most of the picture unchanged
//! and lets lamps fade into white.

use equilux_formats::Rgb;
use std::f64::consts::PI;

/// The end of the straight part of the tone curve.
const KNEE: f64 = 0.8;
/// The share of the picture that stays below the knee.
const BELOW_KNEE_SHARE: f64 = 0.95;

/// The factor k on radiance, (W/(m²·sr))⁻¹.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Exposure(pub f64);

impl Exposure {
    /// Map the 95th percentile of the displayed luminance to 0.8. Lamps are excluded unless nothing else is lit;
    /// without any light the factor is 1.
    ///
    /// `shown`: the elements, each as often as it is displayed. `radiosity` and `emission`: W/m², one row an element.
    pub fn choose<I: Iterator<Item = usize>>(
        shown: impl Fn() -> I,
        radiosity: &[Rgb],
        emission: &[Rgb],
    ) -> Self {
        let lit = |lamps: bool| {
            let counts = shown().filter(|&e| lamps || emission[e] == Rgb::BLACK);
            bright(counts.map(|e| radiosity[e].luminance() / PI).filter(|light| light.is_normal()).collect())
        };
        Self(lit(false).or_else(|| lit(true)).map_or(1.0, |light| KNEE / light))
    }

    /// The displayed colour of `radiosity` (W/m²): linear RGB, 0..1.
    pub fn shown(self, radiosity: Rgb) -> Rgb {
        radiosity.map(|b| tone(self.0 * b / PI))
    }
}

/// The 95th percentile of `lights`.
fn bright(mut lights: Vec<f64>) -> Option<f64> {
    let rank = (lights.len().checked_sub(1)? as f64 * BELOW_KNEE_SHARE) as usize;
    Some(*lights.select_nth_unstable_by(rank, f64::total_cmp).1)
}

fn tone(x: f64) -> f64 {
    let shoulder = 1.0 - KNEE;
    if x > KNEE { 1.0 - shoulder * (-(x - KNEE) / shoulder).exp() } else { x.max(0.0) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_tone_curve_rises_from_zero_to_one_without_a_kink() {
        let step = 1e-3;
        for i in 0..5000 {
            let x = f64::from(i) * step;
            let rise = (tone(x + step) - tone(x)) / step;
            // exp(−5) of the shoulder's slope is left at 1.8, and f64 rounding after that.
            assert!((-1e-9..=1.0 + 1e-9).contains(&rise), "slope {rise} at {x}");
        }
        assert_eq!((tone(-1.0), tone(0.0), tone(f64::NAN)), (0.0, 0.0, 0.0));
        assert_eq!(tone(f64::INFINITY), 1.0);
    }
}
