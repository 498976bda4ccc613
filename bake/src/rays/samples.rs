//! Tables of ray directions and origins, made once. A row takes one of 64 scrambled point sets and turns and shifts it, which
//! is as good as a set of its own and much cheaper.

use super::sobol;
use std::f64::consts::{FRAC_PI_2, FRAC_PI_4};

/// Number of point sets.
const SETS: u32 = 64;

/// The rays of R points for each of the sets.
#[derive(Debug)]
pub struct Samples {
    rays: usize,
    samples: Vec<Sample>,
}

/// One ray, relative to its element.
#[derive(Debug, Clone, Copy)]
pub struct Sample {
    /// Direction: cosine-distributed around +z, unit length.
    pub direction: [f64; 3],
    /// Origin in the unit square.
    pub origin: [f64; 2],
}

impl Samples {
    /// Tables of `rays` rays a row, a power of two.
    pub fn new(rays: u32) -> Self {
        assert!(rays.is_power_of_two(), "{rays} rays");
        let mut samples = Vec::with_capacity(rays as usize * SETS as usize);
        for set in 0..SETS {
            let mut own: Vec<_> = (0..rays).map(|i| sobol::point(i, sobol::hash(set + 77))).collect();
            // Rays with similar directions after each other find what they need in the cache.
            own.sort_by_key(|p| morton(p[0], p[1]));
            samples.extend(own.into_iter().map(sample));
        }
        Self { rays: rays as usize, samples }
    }

    /// Number of rays a row.
    pub fn rays(&self) -> usize {
        self.rays
    }

    /// The rays of the `number`th set, modulo the number of sets.
    #[inline(always)]
    pub fn set(&self, number: u32) -> &[Sample] {
        let start = (number % SETS) as usize * self.rays;
        &self.samples[start..start + self.rays]
    }
}

fn sample([a, b, u, v]: [f64; sobol::DIMENSIONS]) -> Sample {
    let [x, y] = disk(a, b);
    Sample { direction: [x, y, (1.0 - x * x - y * y).max(0.0).sqrt()], origin: [u, v] }
}

/// The point of the unit disk that belongs to a point of the unit square; areas keep their ratios (Shirley & Chiu 1997).
/// Lifted to the hemisphere, uniform points of the disk are cosine-distributed (Nusselt).
fn disk(u: f64, v: f64) -> [f64; 2] {
    let (a, b) = (2.0 * u - 1.0, 2.0 * v - 1.0);
    if a == 0.0 && b == 0.0 {
        return [0.0, 0.0];
    }
    let (radius, angle) =
        if a.abs() > b.abs() { (a, FRAC_PI_4 * b / a) } else { (b, FRAC_PI_2 - FRAC_PI_4 * a / b) };
    [radius * angle.cos(), radius * angle.sin()]
}

/// The place of a point on a Z-shaped curve through a grid of 64 × 64 cells.
fn morton(u: f64, v: f64) -> u32 {
    let spread = |x: f64| (0..6).map(|bit| ((x * 64.0) as u32 >> bit & 1) << (2 * bit)).sum::<u32>();
    spread(u) | spread(v) << 1
}
