//! Quantities in three colour channels.

use serde::{Deserialize, Serialize};
use std::iter::Sum;
use std::ops::{Add, AddAssign, Deref, DerefMut, Div, Mul, Sub};

/// Red, green, blue; linear, BT.709 primaries. Arithmetic is channel by channel.
#[derive(Debug, Clone, Copy, Default, PartialEq, PartialOrd, Serialize, Deserialize)]
#[serde(transparent)]
pub struct Rgb(pub [f64; 3]);

impl Rgb {
    /// Zero in all channels.
    pub const BLACK: Self = Self([0.0; 3]);

    /// One in all channels: as a reflectance, all light.
    pub const WHITE: Self = Self([1.0; 3]);

    /// The same in all channels.
    pub const fn splat(value: f64) -> Self {
        Self([value; 3])
    }

    /// The channels of several values, one value after the other.
    pub fn channels(lights: &[Self]) -> Vec<f64> {
        lights.iter().flat_map(|light| light.0).collect()
    }

    /// The value of `channel` for each channel number, 0 to 2.
    pub fn from_fn(channel: impl FnMut(usize) -> f64) -> Self {
        Self(std::array::from_fn(channel))
    }

    /// The value of `map` for each channel.
    pub fn map(self, channel: impl FnMut(f64) -> f64) -> Self {
        Self(self.0.map(channel))
    }

    /// The magnitude of each channel.
    pub fn abs(self) -> Self {
        self.map(f64::abs)
    }

    /// The larger of each channel.
    pub fn max(self, other: Self) -> Self {
        Self::from_fn(|c| self[c].max(other[c]))
    }

    /// The smaller of each channel.
    pub fn min(self, other: Self) -> Self {
        Self::from_fn(|c| self[c].min(other[c]))
    }

    /// The largest channel, at least 0.
    pub fn brightest(self) -> f64 {
        self.0.into_iter().fold(0.0, f64::max)
    }

    /// Luminance in the unit of the value (ITU-R BT.709, item 3.2).
    pub fn luminance(self) -> f64 {
        let Self([red, green, blue]) = self;
        0.2126 * red + 0.7152 * green + 0.0722 * blue
    }
}

impl From<[f64; 3]> for Rgb {
    fn from(channels: [f64; 3]) -> Self {
        Self(channels)
    }
}

impl PartialEq<[f64; 3]> for Rgb {
    fn eq(&self, other: &[f64; 3]) -> bool {
        self.0 == *other
    }
}

impl Deref for Rgb {
    type Target = [f64; 3];

    fn deref(&self) -> &[f64; 3] {
        &self.0
    }
}

impl DerefMut for Rgb {
    fn deref_mut(&mut self) -> &mut [f64; 3] {
        &mut self.0
    }
}

impl Add for Rgb {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self([self.0[0] + other.0[0], self.0[1] + other.0[1], self.0[2] + other.0[2]])
    }
}

impl AddAssign for Rgb {
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

impl Sub for Rgb {
    type Output = Self;

    fn sub(self, other: Self) -> Self {
        Self([self.0[0] - other.0[0], self.0[1] - other.0[1], self.0[2] - other.0[2]])
    }
}

impl Mul for Rgb {
    type Output = Self;

    fn mul(self, other: Self) -> Self {
        Self([self.0[0] * other.0[0], self.0[1] * other.0[1], self.0[2] * other.0[2]])
    }
}

impl Mul<f64> for Rgb {
    type Output = Self;

    fn mul(self, factor: f64) -> Self {
        self.map(|value| value * factor)
    }
}

impl Div<f64> for Rgb {
    type Output = Self;

    fn div(self, divisor: f64) -> Self {
        self.map(|value| value / divisor)
    }
}

impl Sum for Rgb {
    fn sum<I: Iterator<Item = Self>>(values: I) -> Self {
        values.fold(Self::BLACK, Self::add)
    }
}

impl IntoIterator for Rgb {
    type Item = f64;
    type IntoIter = std::array::IntoIter<f64, 3>;

    fn into_iter(self) -> Self::IntoIter {
        self.0.into_iter()
    }
}

impl<'a> IntoIterator for &'a Rgb {
    type Item = &'a f64;
    type IntoIter = std::slice::Iter<'a, f64>;

    fn into_iter(self) -> Self::IntoIter {
        self.0.iter()
    }
}
