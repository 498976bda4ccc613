//! Gauss-Seidel: B_i ← q_i + ρ_i Σ_j F_ij B_j, each element at once with the newest values. Cohen & Wallace 1993,
//! ch. 5.3.

use super::{ROUNDING, added, largest, scaled};
use equilux_formats::{Rgb, Rows};

/// Sweeps after which a change below 1e-12 that no longer shrinks is taken for rounding.
const PATIENCE: usize = 10;

/// Sweep until the changes are rounding.
pub fn solve(block: &Rows, reflectance: &[Rgb], sources: &[Rgb], guess: &[Rgb]) -> Vec<Rgb> {
    let mut b = guess.to_vec();
    let (mut best, mut since_best) = (f64::INFINITY, 0);
    loop {
        let change = sweep(block, reflectance, sources, &mut b);
        if change < best * 0.99 {
            (best, since_best) = (change, 0);
        } else {
            since_best += 1;
        }
        if change <= ROUNDING || (since_best >= PATIENCE && change <= 1e-12) {
            return b;
        }
    }
}

/// One sweep; returns the largest change relative to the channel's largest radiosity.
fn sweep(block: &Rows, reflectance: &[Rgb], sources: &[Rgb], b: &mut [Rgb]) -> f64 {
    let mut change = [0.0f64; 3];
    for i in 0..b.len() {
        let new = added(sources[i], scaled(reflectance[i], block.gather(i, b)));
        change = std::array::from_fn(|c| change[c].max((new[c] - b[i][c]).abs()));
        b[i] = new;
    }
    let most = largest(b);
    (0..3).map(|c| if change[c] == 0.0 { 0.0 } else { change[c] / most[c] }).fold(0.0, f64::max)
}
