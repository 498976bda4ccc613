//! LU factorisation of I − ρF, one a distinct colour channel, and solves with it. nalgebra is single-threaded, so
//! results do not depend on the number of threads; parts are factorised in parallel.

use equilux_formats::baked::{Factors, Lu};
use equilux_formats::{ClusterTree, Rgb, Rows};
use nalgebra::{DMatrix, DMatrixView, DVector, LU};

/// Factorises I − ρF for every distinct channel of ρ.
pub fn factorise(block: &Rows, clusters: &ClusterTree, reflectance: &[Rgb]) -> Factors {
    distinct(
        |c, d| reflectance.iter().all(|rho| rho[c] == rho[d]),
        |channel| lu(block, clusters, reflectance, channel),
    )
}

/// Factorises each channel that does not equal an earlier one.
fn distinct(are_twins: impl Fn(usize, usize) -> bool, factor: impl Fn(usize) -> Lu) -> Factors {
    let mut channels = Vec::new();
    let mut of_channel = [0u32; 3];
    for c in 0..3 {
        of_channel[c] = (0..c).find(|&d| are_twins(c, d)).map_or_else(
            || {
                channels.push(factor(c));
                channels.len() as u32 - 1
            },
            |twin| of_channel[twin],
        );
    }
    Factors { channels, of_channel }
}

fn lu(block: &Rows, clusters: &ClusterTree, reflectance: &[Rgb], channel: usize) -> Lu {
    let n = block.receivers();
    let mut matrix = DMatrix::<f64>::identity(n, n);
    for i in 0..n {
        for (node, value) in block.row(i) {
            let value = reflectance[i][channel] * value;
            clusters.spread(node, &mut |j, share| matrix[(i, j)] -= value * share);
        }
    }
    factored(matrix)
}

/// Factorises three `size × size` matrices, one a channel. `entries` are row-major.
pub fn factorise_dense(size: usize, entries: &[Rgb]) -> Factors {
    assert_eq!(entries.len(), size * size, "an entry a row and column");
    distinct(
        |c, d| entries.iter().all(|entry| entry[c] == entry[d]),
        |channel| factored(DMatrix::from_fn(size, size, |row, column| entries[row * size + column][channel])),
    )
}

/// Columns that are factorised together. Everything beside them is updated by one matrix product, which is much faster
/// than column by column.
const PANEL: usize = 64;

/// Blocked right-looking LU with partial pivoting (Golub & Van Loan 2013, §3.4.9).
fn factored(mut matrix: DMatrix<f64>) -> Lu {
    let size = matrix.nrows();
    let mut rows = DVector::from_iterator(size, 0..size as u32);
    for start in (0..size).step_by(PANEL) {
        let end = (start + PANEL).min(size);
        let panel = LU::new(matrix.view_range(start.., start..end).into_owned());
        panel.p().permute_rows(&mut matrix.rows_range_mut(start..));
        panel.p().permute_rows(&mut rows.rows_range_mut(start..));
        matrix.view_range_mut(start.., start..end).copy_from(panel.lu_internal());
        let (lower, mut right) = matrix.columns_range_pair_mut(start..end, end..);
        let (mut upper, mut rest) = right.rows_range_pair_mut(start..end, end..);
        lower.rows_range(start..end).solve_lower_triangular_with_diag_mut(&mut upper, 1.0);
        rest.gemm(-1.0, &lower.rows_range(end..), &upper, 1.0);
    }
    Lu { size: size as u32, packed: matrix.as_slice().to_vec(), rows: rows.as_slice().to_vec() }
}

/// B = U⁻¹ L⁻¹ P q.
pub fn solve(factors: &Factors, sources: &[Rgb]) -> Vec<Rgb> {
    let mut solution = vec![Rgb::BLACK; sources.len()];
    for (channel, lu) in factors.channels.iter().enumerate() {
        let n = lu.size as usize;
        let served: Vec<usize> = (0..3).filter(|&c| factors.of_channel[c] as usize == channel).collect();
        let mut x = DMatrix::from_fn(n, served.len(), |i, c| sources[lu.rows[i] as usize][served[c]]);
        let matrix = DMatrixView::from_slice(&lu.packed, n, n);
        matrix.solve_lower_triangular_with_diag_mut(&mut x, 1.0);
        matrix.solve_upper_triangular_unchecked_mut(&mut x);
        for (i, b) in solution.iter_mut().enumerate() {
            served.iter().enumerate().for_each(|(c, &channel)| b[channel] = x[(i, c)]);
        }
    }
    solution
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A matrix that needs pivots, of more than one panel: P A = L U to a few roundings of each of its `size` terms.
    #[test]
    fn factors_multiply_to_the_matrix_with_its_rows_permuted() {
        for size in [1, 5, PANEL, PANEL + 1, 3 * PANEL - 7] {
            let entry = |row: usize, column: usize| {
                ((row * 37 + column * 101 + row * column) % 97) as f64 / 97.0 - 0.5
            };
            let lu = factored(DMatrix::from_fn(size, size, entry));
            let packed = |row: usize, column: usize| lu.packed[column * size + row];
            for row in 0..size {
                for column in 0..size {
                    let lower = |k: usize| if k == row { 1.0 } else { packed(row, k) };
                    let product: f64 = (0..=row.min(column)).map(|k| lower(k) * packed(k, column)).sum();
                    let off = (product - entry(lu.rows[row] as usize, column)).abs();
                    assert!(off <= 1e-13 * size as f64, "{size}: {row}, {column} is off by {off:e}");
                }
            }
        }
    }
}
