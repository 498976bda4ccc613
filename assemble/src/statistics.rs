//! Sums over a whole scene: means, differences and row sums.

use crate::exchange::system::InstanceSystem;
use equilux_formats::rows::RowSumDefect;
use equilux_formats::{Element, Rgb};
use rayon::prelude::*;

/// The mean over the scene's area, channel by channel.
pub fn mean_over_area(elements: &[Element], values: &[Rgb]) -> Rgb {
    let (mut sum, mut total) = (Rgb::BLACK, 0.0);
    for (element, value) in elements.iter().zip(values) {
        sum += *value * element.area;
        total += element.area;
    }
    sum / total
}

/// √(Σ w d² / Σ w) / (Σ w u / Σ w), the worst channel: the root mean square of differences d relative to the mean of
/// u, from rows (d, u, w). A channel without differences gives 0, whatever its mean.
pub fn weighted_rms_over_mean(rows: impl Iterator<Item = (Rgb, Rgb, f64)>) -> f64 {
    let (mut squares, mut sums, mut weights) = (Rgb::BLACK, Rgb::BLACK, 0.0);
    for (difference, unit, weight) in rows {
        for c in 0..3 {
            squares[c] += weight * difference[c] * difference[c];
            sums[c] += weight * unit[c];
        }
        weights += weight;
    }
    let of =
        |c: usize| if squares[c] == 0.0 { 0.0 } else { (squares[c] / weights).sqrt() / (sums[c] / weights) };
    (0..3).map(of).fold(0.0, f64::max)
}

/// The root mean square of `values` relative to the mean of `unit`, both over the scene's area; the worst channel.
pub fn rms_over_mean(elements: &[Element], values: &[Rgb], unit: &[Rgb]) -> f64 {
    let rows = elements.iter().zip(values).zip(unit);
    weighted_rms_over_mean(rows.map(|((element, &value), &unit)| (value, unit, element.area)))
}

/// The distance of the row sums of the whole matrix from one.
pub fn row_sum_defect(systems: &[InstanceSystem]) -> RowSumDefect {
    let sums = systems.par_iter().map(|system| row_sums(system).collect()).collect::<Vec<Vec<f64>>>();
    RowSumDefect::of(&sums.concat())
}

/// Σ_j F_ij of every receiver of an instance, over all senders of the scene.
pub fn row_sums<'a>(system: &'a InstanceSystem<'a>) -> impl Iterator<Item = f64> + 'a {
    (0..system.self_block.receivers()).map(|i| system.self_block.row_sum(i) + system.coupling.row_sum(i))
}

/// The largest difference between two radiosities, element by element, relative to the larger of the two. Differences
/// below half a rounding unit (2⁻⁵³) of the brightest radiosity count as 0, since form factors of at most 1 have the
/// same accuracy.
pub fn largest_difference(a: &[Rgb], b: &[Rgb]) -> f64 {
    let brightest = b.iter().flatten().fold(0.0f64, |most, v| most.max(v.abs()));
    let rounding = brightest * f64::EPSILON / 2.0;
    let pairs = a.iter().flatten().zip(b.iter().flatten());
    pairs
        .map(|(&a, &b)| if (a - b).abs() <= rounding { 0.0 } else { (a - b).abs() / a.abs().max(b.abs()) })
        .fold(0.0, f64::max)
}

/// The root mean square difference relative to the mean of `b`, weighted by area; the worst channel.
pub fn mean_difference(elements: &[Element], a: &[Rgb], b: &[Rgb]) -> f64 {
    let differences: Vec<Rgb> = a.iter().zip(b).map(|(&a, &b)| a - b).collect();
    rms_over_mean(elements, &differences, b)
}
