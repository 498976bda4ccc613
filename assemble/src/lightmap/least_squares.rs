//! The least change of values that makes differences between them vanish. In go values, rows c_k over them that should be
//! zero, and pairs that lie beside each other; out comes the change.
//!
//! With v the values the change y minimises |y|² + μ Σ_(i, j) (y_i − y_j)² + λ Σ_k (c_k·(v + y))²: it is small and even, so
//! that whatever detail v has stays. With D the rows of pairs, (I + μDᵀD + λCᵀC) y = −λCᵀC v, solved by conjugate gradients
//! (Hestenes & Stiefel 1952), one after the other, so that the bits do not depend on threads.

/// A row: numbers of values, with weights.
pub type Difference = Vec<(usize, f64)>;

/// λ: a jump shrinks to about a thousandth.
const STIFFNESS: f64 = 1e3;
/// μ: a change fades over about three values.
const EVENNESS: f64 = 10.0;
/// Conjugate gradients end when the residual has shrunk by this factor; half floats keep 5e-4.
const ENOUGH: f64 = 1e-7;
/// More steps than a system of this stiffness ever needs.
const MOST_STEPS: usize = 1000;

/// The change y of the values `v`.
pub fn correction(rows: &[Difference], pairs: &[[usize; 2]], v: &[f64]) -> Vec<f64> {
    let apply = |x: &[f64]| {
        let mut y = x.to_vec();
        add_evenness(pairs, x, &mut y);
        add_agreement(rows, x, &mut y);
        y
    };
    let mut y = vec![0.0; v.len()];
    let mut residual = vec![0.0; v.len()];
    add_agreement(rows, v, &mut residual);
    residual.iter_mut().for_each(|r| *r = -*r);
    let mut direction = residual.clone();
    let mut square = dot(&residual, &residual);
    let goal = square * ENOUGH * ENOUGH;
    for _ in 0..MOST_STEPS {
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
    y
}

/// y += μDᵀD x.
fn add_evenness(pairs: &[[usize; 2]], x: &[f64], y: &mut [f64]) {
    for &[i, j] in pairs {
        let force = EVENNESS * (x[i] - x[j]);
        y[i] += force;
        y[j] -= force;
    }
}

/// y += λCᵀC x.
fn add_agreement(rows: &[Difference], x: &[f64], y: &mut [f64]) {
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
