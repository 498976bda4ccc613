//! Flexible GMRES on three channels at once: one matrix application serves red, green and blue, while each channel
//! has its own Krylov space and stops on its own. Saad & Schultz 1986; Saad 1993 for the flexible form.

use super::{added, largest, scaled, subtract};
use equilux_formats::Rgb;

/// Directions kept before the residual is taken afresh.
const RESTART: usize = 40;

/// Restarts after which the answer is returned as it is; the caller's own bound then says how good it is.
const RESTARTS: usize = 200;

/// Improve `x` until ‖rhs − A x‖∞ ≤ tolerance × ‖x‖∞ in every channel, or until rounding stops all progress. Returns
/// the number of applications of A. `precondition` approximates A⁻¹ and may differ from call to call.
pub fn gmres(
    mut apply: impl FnMut(&[Rgb]) -> Vec<Rgb>,
    mut precondition: impl FnMut(&[Rgb]) -> Vec<Rgb>,
    rhs: &[Rgb],
    x: &mut [Rgb],
    tolerance: f64,
) -> usize {
    let mut applications = 0;
    let mut previous = [f64::INFINITY; 3];
    for _ in 0..RESTARTS {
        let ax = apply(x);
        applications += 1;
        let residual: Vec<Rgb> = rhs.iter().zip(&ax).map(|(&b, &a)| subtract(b, a)).collect();
        let (left, scale) = (largest(&residual), largest(x));
        let open: [bool; 3] =
            std::array::from_fn(|c| left[c] > tolerance * scale[c] && left[c] < 0.5 * previous[c]);
        if open == [false; 3] {
            break;
        }
        previous = left;
        let target = std::array::from_fn(|c| tolerance * scale[c].max(left[c]));
        applications += cycle(&mut apply, &mut precondition, &residual, open, target, x);
    }
    applications
}

/// One restart cycle: x ← x + Z y, with y minimising ‖residual − A Z y‖ in each channel.
fn cycle(
    apply: &mut impl FnMut(&[Rgb]) -> Vec<Rgb>,
    precondition: &mut impl FnMut(&[Rgb]) -> Vec<Rgb>,
    residual: &[Rgb],
    open: [bool; 3],
    target: Rgb,
    x: &mut [Rgb],
) -> usize {
    let mut least = LeastSquares::new(std::array::from_fn(|c| if open[c] { norm(residual)[c] } else { 0.0 }));
    let mut basis = vec![normalised(residual, least.residual)];
    let mut directions: Vec<Vec<Rgb>> = Vec::new();
    while directions.len() < RESTART && (0..3).any(|c| least.residual[c].abs() > target[c]) {
        let z = precondition(&basis[directions.len()]);
        let mut w = apply(&z);
        directions.push(z);
        let column = orthogonalise(&mut w, &basis);
        let length = norm(&w);
        basis.push(normalised(&w, length));
        least.add_column(column, length);
    }
    for (y, z) in least.solve().into_iter().zip(&directions) {
        x.iter_mut().zip(z).for_each(|(x, &z)| *x = added(*x, scaled(y, z)));
    }
    directions.len()
}

/// Take the components along `basis` out of `w` (modified Gram-Schmidt, twice) and return them.
fn orthogonalise(w: &mut [Rgb], basis: &[Vec<Rgb>]) -> Vec<Rgb> {
    let mut column = vec![[0.0; 3]; basis.len()];
    for _ in 0..2 {
        for (h, v) in column.iter_mut().zip(basis) {
            let along = dot(w, v);
            w.iter_mut().zip(v).for_each(|(w, &v)| *w = subtract(*w, scaled(along, v)));
            *h = added(*h, along);
        }
    }
    column
}

fn dot(a: &[Rgb], b: &[Rgb]) -> Rgb {
    a.iter().zip(b).fold([0.0; 3], |sum, (&a, &b)| added(sum, scaled(a, b)))
}

/// The Euclidean norm of each channel, safe from overflow: squares of 1e200 would be infinite.
fn norm(v: &[Rgb]) -> Rgb {
    let most = largest(v);
    let unit = most.map(|m| if m > 0.0 { m } else { 1.0 });
    let squares = v
        .iter()
        .fold([0.0; 3], |sum, v| std::array::from_fn(|c| sum[c] + (v[c] / unit[c]) * (v[c] / unit[c])));
    std::array::from_fn(|c| squares[c].sqrt() * most[c])
}

/// The vector over its length; a channel without length stays out of the game as zeros.
fn normalised(v: &[Rgb], length: Rgb) -> Vec<Rgb> {
    v.iter().map(|v| std::array::from_fn(|c| if length[c] > 0.0 { v[c] / length[c] } else { 0.0 })).collect()
}

/// min ‖β e₁ − H y‖ for the growing Hessenberg matrix H, by Givens rotations, channel by channel.
struct LeastSquares {
    /// Columns of the triangular factor.
    columns: Vec<Vec<Rgb>>,
    rotations: Vec<(Rgb, Rgb)>,
    rhs: Vec<Rgb>,
    /// What is left of the residual's norm.
    residual: Rgb,
}

impl LeastSquares {
    fn new(beta: Rgb) -> Self {
        Self { columns: vec![], rotations: vec![], rhs: vec![], residual: beta }
    }

    fn add_column(&mut self, mut column: Vec<Rgb>, below: Rgb) {
        for (k, (cos, sin)) in self.rotations.iter().enumerate() {
            let (upper, lower) = (column[k], column[k + 1]);
            column[k] = added(scaled(*cos, upper), scaled(*sin, lower));
            column[k + 1] = subtract(scaled(*cos, lower), scaled(*sin, upper));
        }
        let last = column.len() - 1;
        let length: Rgb = std::array::from_fn(|c| column[last][c].hypot(below[c]));
        let over = |v: Rgb, identity: f64| {
            std::array::from_fn(|c| if length[c] > 0.0 { v[c] / length[c] } else { identity })
        };
        let (cos, sin) = (over(column[last], 1.0), over(below, 0.0));
        column[last] = length;
        self.columns.push(column);
        self.rotations.push((cos, sin));
        self.rhs.push(scaled(cos, self.residual));
        self.residual = scaled(sin.map(|s| -s), self.residual);
    }

    fn solve(&self) -> Vec<Rgb> {
        let mut y = self.rhs.clone();
        for k in (0..y.len()).rev() {
            let pivot = self.columns[k][k];
            y[k] = std::array::from_fn(|c| if pivot[c] > 0.0 { y[k][c] / pivot[c] } else { 0.0 });
            for above in 0..k {
                y[above] = subtract(y[above], scaled(self.columns[k][above], y[k]));
            }
        }
        y
    }
}
