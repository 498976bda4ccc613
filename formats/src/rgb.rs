//! Light in three channels.

/// Red, green, blue; linear, BT.709 primaries.
pub type Rgb = [f64; 3];

/// Luminance of linear RGB with BT.709 primaries, in its unit (ITU-R BT.709, item 3.2).
pub fn luminance([red, green, blue]: Rgb) -> f64 {
    0.2126 * red + 0.7152 * green + 0.0722 * blue
}
