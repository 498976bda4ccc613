//! Arithmetic channel by channel.

use equilux_formats::Rgb;

/// a × b, channel by channel.
pub fn scaled(a: Rgb, b: Rgb) -> Rgb {
    [a[0] * b[0], a[1] * b[1], a[2] * b[2]]
}

/// a + b, channel by channel.
pub fn added(a: Rgb, b: Rgb) -> Rgb {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

/// a − b, channel by channel.
pub fn subtract(a: Rgb, b: Rgb) -> Rgb {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

/// The largest magnitude in each channel.
pub fn largest(values: &[Rgb]) -> Rgb {
    values.iter().fold([0.0; 3], |most, v| std::array::from_fn(|c| f64::max(most[c], v[c].abs())))
}
