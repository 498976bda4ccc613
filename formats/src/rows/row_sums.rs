//! How far the row sums of a matrix of form factors are from one.

use serde::Serialize;

/// Distance of row sums from one: zero in a closed scene.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize)]
pub struct RowSumDefect {
    /// The worst row.
    pub max: f64,
    /// The mean over all rows.
    pub mean: f64,
    /// By how much the largest sum exceeds one; 0 if none does.
    pub excess: f64,
}

impl RowSumDefect {
    /// The defect of rows with these sums.
    pub fn of(sums: &[f64]) -> Self {
        let over = || sums.iter().map(|sum| sum - 1.0);
        Self {
            max: over().map(f64::abs).fold(0.0, f64::max),
            mean: over().map(f64::abs).sum::<f64>() / sums.len().max(1) as f64,
            excess: over().fold(0.0, f64::max),
        }
    }
}
