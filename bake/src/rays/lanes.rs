//! Eight numbers at once. Loops over all of them that neither branch nor store in between are compiled to vector instructions.

/// Numbers that are computed with at once.
pub const LANES: usize = 8;

/// Eight numbers.
#[repr(C, align(32))]
#[derive(Debug, Clone, Copy)]
pub struct Lanes(pub [f32; LANES]);

impl Lanes {
    /// The same number eight times.
    pub const fn all(value: f32) -> Self {
        Self([value; LANES])
    }
}

/// Some of the eight, as a bit in each of eight bytes: what flags are in memory.
#[derive(Debug, Clone, Copy)]
pub struct Mask(u64);

impl Mask {
    /// The lanes whose flags are set.
    #[inline(always)]
    pub fn of(flags: [bool; LANES]) -> Self {
        Self(u64::from_le_bytes(flags.map(u8::from)))
    }

    /// Whether the lane is one of these.
    #[inline(always)]
    pub fn has(self, lane: usize) -> bool {
        self.0 >> (8 * lane) & 1 != 0
    }
}

impl Iterator for Mask {
    type Item = usize;

    #[inline(always)]
    fn next(&mut self) -> Option<usize> {
        let lane = (self.0 != 0).then(|| self.0.trailing_zeros() as usize / 8);
        self.0 &= self.0.wrapping_sub(1);
        lane
    }
}

/// Unlike f32::max this becomes one instruction. Of a number and what is no number it is the second.
#[inline(always)]
pub fn max(a: f32, b: f32) -> f32 {
    if a > b { a } else { b }
}

/// Like [`max`].
#[inline(always)]
pub fn min(a: f32, b: f32) -> f32 {
    if a < b { a } else { b }
}
