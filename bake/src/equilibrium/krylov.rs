//! Flexible GMRES on three channels at once: one matrix application serves red, green and blue, while each channel has
//! its own Krylov space and stopping test. Saad & Schultz 1986; Saad 1993 for the flexible form.
//!
//! The caller supplies the matrix as a function of a vector: it may be dense, hierarchical, or blocks between parts.

use super::channels::largest;
use equilux_formats::Rgb;
use rayon::prelude::*;

/// Directions kept before the method restarts from the residual.
const RESTART: usize = 40;

/// The largest number of restarts. The result is then returned as it is; callers compute their own error bound.
const MAX_RESTARTS: usize = 200;

/// Elements a partial sum. Partial sums of fixed size, added in order, do not depend on the number of threads.
const PARTIAL_SUM: usize = 2048;

/// If orthogonalisation leaves less than this share of a vector, it is repeated. Vectors are then orthogonal to 1e-13.
const REORTHOGONALISE_BELOW: f64 = 1e-3;

/// Sums of squares in this range have neither overflowed nor underflowed.
const SAFE: std::ops::Range<f64> = 1e-280..1e280;

/// Improves `x` until ‖rhs − A x‖∞ ≤ tolerance × ‖x‖∞ in every channel, or until rounding prevents progress.
/// `precondition` approximates A⁻¹ and may differ from call to call.
pub fn gmres(
    mut apply: impl FnMut(&[Rgb]) -> Vec<Rgb>,
    mut precondition: impl FnMut(&[Rgb]) -> Vec<Rgb>,
    rhs: &[Rgb],
    x: &mut [Rgb],
    tolerance: f64,
) {
    let mut previous = Rgb::splat(f64::INFINITY);
    for _ in 0..MAX_RESTARTS {
        let ax = apply(x);
        let residual: Vec<Rgb> = rhs.iter().zip(&ax).map(|(&b, &a)| b - a).collect();
        let (left, scale) = (largest(&residual), largest(x));
        let open: [bool; 3] =
            std::array::from_fn(|c| left[c] > tolerance * scale[c] && left[c] < 0.5 * previous[c]);
        if open == [false; 3] {
            break;
        }
        previous = left;
        let target: Rgb = Rgb::from_fn(|c| tolerance * scale[c].max(left[c]));
        let residual: Vec<Rgb> =
            residual.iter().map(|r| Rgb::from_fn(|c| if open[c] { r[c] } else { 0.0 })).collect();
        let mut space = Space::new(&residual);
        while !space.is_full() && (0..3).any(|c| space.left()[c] > target[c]) {
            let z = precondition(space.newest());
            let az = apply(&z);
            space.add(z, az);
        }
        x.iter_mut().zip(space.correction()).for_each(|(x, z)| *x += z);
    }
}

/// An approximate solution z with ‖rhs − A z‖ ≤ `share` × ‖rhs‖ in every channel, or the best after `RESTART`
/// directions, and its residual rhs − A z.
pub fn roughly(mut apply: impl FnMut(&[Rgb]) -> Vec<Rgb>, rhs: &[Rgb], share: f64) -> (Vec<Rgb>, Vec<Rgb>) {
    let mut space = Space::new(rhs);
    let target = space.left() * share;
    while !space.is_full() && (0..3).any(|c| space.left()[c] > target[c]) {
        let z = space.newest().to_vec();
        let az = apply(&z);
        space.add(z, az);
    }
    (space.correction(), space.residual())
}

/// A Krylov space that grows by one direction a round, and the correction in it that leaves the least residual: z = Z y
/// with y minimising ‖r − A Z y‖ in each channel.
#[derive(Debug)]
pub struct Space {
    /// An orthonormal basis of r and A Z.
    basis: Vec<Vec<Rgb>>,
    /// Z.
    directions: Vec<Vec<Rgb>>,
    least: LeastSquares,
}

impl Space {
    /// The space that holds only the residual.
    pub fn new(residual: &[Rgb]) -> Self {
        let length = norm(residual);
        let mut first = residual.to_vec();
        normalise(&mut first, length);
        Self { basis: vec![first], directions: vec![], least: LeastSquares::new(length) }
    }

    /// The newest basis vector, from which callers derive the next direction.
    pub fn newest(&self) -> &[Rgb] {
        &self.basis[self.directions.len()]
    }

    /// Adds a direction z, usually the preconditioned newest basis vector, and A z.
    pub fn add(&mut self, z: Vec<Rgb>, mut az: Vec<Rgb>) {
        self.directions.push(z);
        let (column, length) = orthogonalise(&mut az, &self.basis);
        normalise(&mut az, length);
        self.basis.push(az);
        self.least.add_column(column, length);
    }

    /// Whether it holds the largest number of directions. Callers then restart from the residual.
    pub fn is_full(&self) -> bool {
        self.directions.len() == RESTART
    }

    /// The norm of the remaining residual in each channel.
    pub fn left(&self) -> Rgb {
        self.least.residual.map(f64::abs)
    }

    /// The best correction.
    pub fn correction(&self) -> Vec<Rgb> {
        combined(&self.least.solve(), &self.directions, self.basis[0].len())
    }

    /// The residual that the best correction leaves.
    pub fn residual(&self) -> Vec<Rgb> {
        combined(&self.least.left_along_basis(), &self.basis, self.basis[0].len())
    }
}

/// Σ share_k vector_k.
fn combined(shares: &[Rgb], vectors: &[Vec<Rgb>], length: usize) -> Vec<Rgb> {
    let mut sum = vec![Rgb::BLACK; length];
    add_combined(&mut sum, shares, vectors);
    sum
}

/// sum += Σ share_k vector_k.
fn add_combined(sum: &mut [Rgb], shares: &[Rgb], vectors: &[Vec<Rgb>]) {
    sum.par_chunks_mut(PARTIAL_SUM).enumerate().for_each(|(number, piece)| {
        for (&share, vector) in shares.iter().zip(vectors) {
            let vector = &vector[number * PARTIAL_SUM..];
            piece.iter_mut().zip(vector).for_each(|(sum, &v)| *sum += share * v);
        }
    });
}

/// Removes the components along `basis` from `w` (Gram-Schmidt, repeated where little is left, after Daniel, Gragg,
/// Kaufman & Stewart 1976). Returns the components and the remaining norm.
fn orthogonalise(w: &mut [Rgb], basis: &[Vec<Rgb>]) -> (Vec<Rgb>, Rgb) {
    let (mut column, mut left) = (vec![Rgb::BLACK; basis.len()], Rgb::BLACK);
    // Twice is enough: Giraud, Langou & Rozložník 2005.
    for _ in 0..2 {
        let along = dots(w, basis);
        let taken: Vec<Rgb> = along.iter().map(|along| along.map(|along| -along)).collect();
        add_combined(w, &taken, basis);
        column.iter_mut().zip(&along).for_each(|(sum, &along)| *sum += along);
        left = norm(w);
        let taken = norm(&along);
        if (0..3).all(|c| left[c] >= REORTHOGONALISE_BELOW * taken[c]) {
            break;
        }
    }
    (column, left)
}

/// The products of a vector with each of several.
fn dots(w: &[Rgb], vectors: &[Vec<Rgb>]) -> Vec<Rgb> {
    let of = |(number, piece): (usize, &[Rgb])| -> Vec<Rgb> {
        vectors.iter().map(|vector| dot(piece, &vector[number * PARTIAL_SUM..])).collect()
    };
    let pieces: Vec<Vec<Rgb>> = w.par_chunks(PARTIAL_SUM).enumerate().map(of).collect();
    (0..vectors.len()).map(|k| pieces.iter().fold(Rgb::BLACK, |sum, piece| sum + piece[k])).collect()
}

fn dot(a: &[Rgb], b: &[Rgb]) -> Rgb {
    a.iter().zip(b).fold(Rgb::BLACK, |sum, (&a, &b)| sum + a * b)
}

/// The Euclidean norm of each channel, safe from overflow: squares of 1e200 would be infinite.
fn norm(v: &[Rgb]) -> Rgb {
    let pieces: Vec<Rgb> = v.par_chunks(PARTIAL_SUM).map(|piece| dot(piece, piece)).collect();
    let squares: Rgb = pieces.into_iter().sum();
    if squares.iter().all(|square| SAFE.contains(square)) {
        return squares.map(f64::sqrt);
    }
    let most = largest(v);
    let unit = most.map(|m| if m > 0.0 { m } else { 1.0 });
    let squares =
        v.iter().fold(Rgb::BLACK, |sum, v| Rgb::from_fn(|c| sum[c] + (v[c] / unit[c]) * (v[c] / unit[c])));
    squares.map(f64::sqrt) * most
}

/// The vector over its length; a channel without length stays out of the game as zeros.
fn normalise(v: &mut [Rgb], length: Rgb) {
    let over = |v: Rgb| Rgb::from_fn(|c| if length[c] > 0.0 { v[c] / length[c] } else { 0.0 });
    v.par_chunks_mut(PARTIAL_SUM).for_each(|piece| piece.iter_mut().for_each(|v| *v = over(*v)));
}

/// min ‖β e₁ − H y‖ for the growing Hessenberg matrix H, by Givens rotations, channel by channel.
#[derive(Debug)]
struct LeastSquares {
    /// Columns of the triangular factor.
    columns: Vec<Vec<Rgb>>,
    rotations: Vec<(Rgb, Rgb)>,
    rhs: Vec<Rgb>,
    /// The remaining norm of the residual.
    residual: Rgb,
}

impl LeastSquares {
    fn new(beta: Rgb) -> Self {
        Self { columns: vec![], rotations: vec![], rhs: vec![], residual: beta }
    }

    fn add_column(&mut self, mut column: Vec<Rgb>, below: Rgb) {
        for (k, (cos, sin)) in self.rotations.iter().enumerate() {
            let (upper, lower) = (column[k], column[k + 1]);
            column[k] = *cos * upper + *sin * lower;
            column[k + 1] = *cos * lower - *sin * upper;
        }
        let last = column.len() - 1;
        let length: Rgb = Rgb::from_fn(|c| column[last][c].hypot(below[c]));
        let over = |v: Rgb, identity: f64| {
            Rgb::from_fn(|c| if length[c] > 0.0 { v[c] / length[c] } else { identity })
        };
        let (cos, sin) = (over(column[last], 1.0), over(below, 0.0));
        column[last] = length;
        self.columns.push(column);
        self.rotations.push((cos, sin));
        self.rhs.push(cos * self.residual);
        self.residual = sin.map(|s| -s) * self.residual;
    }

    fn solve(&self) -> Vec<Rgb> {
        let mut y = self.rhs.clone();
        for k in (0..y.len()).rev() {
            let pivot = self.columns[k][k];
            y[k] = Rgb::from_fn(|c| if pivot[c] > 0.0 { y[k][c] / pivot[c] } else { 0.0 });
            for above in 0..k {
                y[above] = y[above] - self.columns[k][above] * y[k];
            }
        }
        y
    }

    /// β e₁ − H y for the best y: the last entry of the rotated right-hand side, rotated back.
    fn left_along_basis(&self) -> Vec<Rgb> {
        let mut left = vec![Rgb::BLACK; self.rotations.len() + 1];
        left[self.rotations.len()] = self.residual;
        for (k, &(cos, sin)) in self.rotations.iter().enumerate().rev() {
            let (upper, lower) = (left[k], left[k + 1]);
            left[k] = cos * upper - sin * lower;
            left[k + 1] = sin * upper + cos * lower;
        }
        left
    }
}
