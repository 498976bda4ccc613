//! Finds the smallest change of values that makes given differences vanish. Input: values and how freely each may change, rows c_k
//! of weights whose sums over the values should be zero, and pairs of adjacent values. Output: the change.
//!
//! For values v of freedom s, the change y minimises Σ (y_i / s_i)² + μ Σ_(i, j) (y_i − y_j)² + λ Σ_k (c_k·(v + y))²: it is
//! small and smooth, so that the detail of v is preserved. With y = S z and D the rows of pairs,
//! (I + S (μDᵀD + λCᵀC) S) z = −λ S CᵀC v is solved by conjugate gradients (Hestenes & Stiefel 1952), sequentially, so that the
//! bits do not depend on threads.

/// A row: indices of values, with weights.
pub type DifferenceRow = Vec<(usize, f64)>;

/// λ: a difference shrinks to about a thousandth.
const STIFFNESS: f64 = 1e3;
/// μ: a change decays over about three values.
const SMOOTHNESS: f64 = 10.0;
/// Residual reduction at which conjugate gradients end; half floats have an accuracy of 5e-4.
const RESIDUAL_REDUCTION: f64 = 1e-7;
/// Maximum number of steps, more than a system of this stiffness needs.
const MAX_STEPS: usize = 1000;

/// The change y of the values `v`, which are as free as `freedom` says, from 0 to 1.
pub fn correction(rows: &[DifferenceRow], pairs: &[[usize; 2]], freedom: &[f64], v: &[f64]) -> Vec<f64> {
    let scaled = |x: &[f64]| -> Vec<f64> { x.iter().zip(freedom).map(|(x, s)| x * s).collect() };
    let apply = |z: &[f64]| {
        let (x, mut forces) = (scaled(z), vec![0.0; z.len()]);
        add_smoothness(pairs, &x, &mut forces);
        add_agreement(rows, &x, &mut forces);
        let mut y = scaled(&forces);
        add(&mut y, 1.0, z);
        y
    };
    let mut y = vec![0.0; v.len()];
    let mut residual = vec![0.0; v.len()];
    add_agreement(rows, v, &mut residual);
    residual = scaled(&residual);
    residual.iter_mut().for_each(|r| *r = -*r);
    let mut direction = residual.clone();
    let mut square = dot(&residual, &residual);
    let goal = square * RESIDUAL_REDUCTION * RESIDUAL_REDUCTION;
    for _ in 0..MAX_STEPS {
        if square <= goal {
            break;
        }
        let image = apply(&direction);
        let step = square / dot(&direction, &image);
        add(&mut y, step, &direction);
        add(&mut residual, -step, &image);
        let next = dot(&residual, &residual);
        direction.iter_mut().zip(&residual).for_each(|(d, r)| *d = r + next / square * *d);
        square = next;
    }
    scaled(&y)
}

/// y += μDᵀD x.
fn add_smoothness(pairs: &[[usize; 2]], x: &[f64], y: &mut [f64]) {
    for &[i, j] in pairs {
        let force = SMOOTHNESS * (x[i] - x[j]);
        y[i] += force;
        y[j] -= force;
    }
}

/// y += λCᵀC x.
fn add_agreement(rows: &[DifferenceRow], x: &[f64], y: &mut [f64]) {
    for row in rows {
        let difference: f64 = row.iter().map(|&(i, weight)| weight * x[i]).sum();
        row.iter().for_each(|&(i, weight)| y[i] += STIFFNESS * difference * weight);
    }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

fn add(to: &mut [f64], factor: f64, other: &[f64]) {
    to.iter_mut().zip(other).for_each(|(to, other)| *to += factor * other);
}
