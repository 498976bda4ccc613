//! LU factors of I − ρF, one a distinct channel, and solves with them. faer, sequential: its bits do not depend on
//! the number of threads, and parts are factored side by side.

use equilux_formats::{ClusterTree, Factors, Lu, Rgb, Rows};
use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::lu::partial_pivoting::factor::{lu_in_place, lu_in_place_scratch};
use faer::linalg::triangular_solve::{solve_unit_lower_triangular_in_place, solve_upper_triangular_in_place};
use faer::{Mat, MatRef, Par};

/// Factor I − ρF for every distinct channel of ρ.
pub fn factorise(block: &Rows, clusters: &ClusterTree, reflectance: &[Rgb]) -> Factors {
    distinct(
        |c, d| reflectance.iter().all(|rho| rho[c] == rho[d]),
        |channel| lu(block, clusters, reflectance, channel),
    )
}

/// The factors of each channel that is no twin of an earlier one.
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
    let mut matrix = Mat::<f64>::identity(n, n);
    for i in 0..n {
        for (node, value) in block.row(i) {
            let value = reflectance[i][channel] * value;
            clusters.spread(node, &mut |j, share| matrix[(i, j)] -= value * share);
        }
    }
    factored(matrix)
}

/// Factor three matrices of the same size, one a channel, `size × size`, given by their entries, row by row.
pub fn factorise_dense(size: usize, entries: &[Rgb]) -> Factors {
    assert_eq!(entries.len(), size * size, "an entry a row and column");
    distinct(
        |c, d| entries.iter().all(|entry| entry[c] == entry[d]),
        |channel| factored(Mat::from_fn(size, size, |row, column| entries[row * size + column][channel])),
    )
}

fn factored(mut matrix: Mat<f64>) -> Lu {
    let n = matrix.nrows();
    let (mut rows, mut inverse) = (vec![0u32; n], vec![0u32; n]);
    let mut memory = MemBuffer::new(lu_in_place_scratch::<u32, f64>(n, n, Par::Seq, Default::default()));
    let stack = MemStack::new(&mut memory);
    lu_in_place(matrix.as_mut(), &mut rows, &mut inverse, Par::Seq, stack, Default::default());
    let packed = (0..n).flat_map(|j| matrix.col_as_slice(j).to_vec()).collect();
    Lu { size: n as u32, packed, rows }
}

/// B = U⁻¹ L⁻¹ P q.
pub fn solve(factors: &Factors, sources: &[Rgb]) -> Vec<Rgb> {
    let mut solution = vec![Rgb::BLACK; sources.len()];
    for (channel, lu) in factors.channels.iter().enumerate() {
        let n = lu.size as usize;
        let served: Vec<usize> = (0..3).filter(|&c| factors.of_channel[c] as usize == channel).collect();
        let mut x = Mat::from_fn(n, served.len(), |i, c| sources[lu.rows[i] as usize][served[c]]);
        let matrix = MatRef::from_column_major_slice(&lu.packed, n, n);
        solve_unit_lower_triangular_in_place(matrix, x.as_mut(), Par::Seq);
        solve_upper_triangular_in_place(matrix, x.as_mut(), Par::Seq);
        for (i, b) in solution.iter_mut().enumerate() {
            served.iter().enumerate().for_each(|(c, &channel)| b[channel] = x[(i, c)]);
        }
    }
    solution
}
