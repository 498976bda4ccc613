//! Arithmetic channel by channel.

use equilux_formats::Rgb;

/// The largest magnitude in each channel.
pub fn largest(values: &[Rgb]) -> Rgb {
    values.iter().fold(Rgb::BLACK, |most, v| most.max(v.abs()))
}
