//! Products of form-factor rows and the radiosities of their senders, the inner loop of every round. Rows are contiguous.

use crate::rgb::Rgb;

/// Rows summed in parallel: enough independent chains of additions to hide their latency.
const ABREAST: usize = 4;

/// The product of each row with `seen`, summed from the first column to the last. `rows` are contiguous in `values`.
pub fn products<T>(values: &[T], seen: &[Rgb], rows: usize, number: impl Fn(&T) -> f64) -> Vec<Rgb> {
    // The widest vector instructions of the machine; the order of operations, and with it the result, does not change.
    pulp::Arch::new().dispatch(Products { values, seen, rows, number })
}

struct Products<'a, T, N> {
    values: &'a [T],
    seen: &'a [Rgb],
    rows: usize,
    number: N,
}

impl<T, N: Fn(&T) -> f64> pulp::NullaryFnOnce for Products<'_, T, N> {
    type Output = Vec<Rgb>;

    #[inline(always)]
    fn call(self) -> Vec<Rgb> {
        // A fourth channel fills a vector register.
        let seen: Vec<[f64; 4]> = self.seen.iter().map(|b| [b[0], b[1], b[2], 0.0]).collect();
        let row = |k: usize| &self.values[k * seen.len()..(k + 1) * seen.len()];
        let mut sums = Vec::with_capacity(self.rows);
        let even = self.rows - self.rows % ABREAST;
        for k in (0..even).step_by(ABREAST) {
            let [a, b, c, d] = [row(k), row(k + 1), row(k + 2), row(k + 3)];
            let mut four = [[0.0; 4]; ABREAST];
            for ((((seen, a), b), c), d) in seen.iter().zip(a).zip(b).zip(c).zip(d) {
                four[0] = plus(four[0], (self.number)(a), seen);
                four[1] = plus(four[1], (self.number)(b), seen);
                four[2] = plus(four[2], (self.number)(c), seen);
                four[3] = plus(four[3], (self.number)(d), seen);
            }
            sums.extend(four);
        }
        for k in even..self.rows {
            sums.push(
                seen.iter().zip(row(k)).fold([0.0; 4], |sum, (b, value)| plus(sum, (self.number)(value), b)),
            );
        }
        sums.iter().map(|&[r, g, b, _]| Rgb([r, g, b])).collect()
    }
}

/// sum + value × b.
#[inline(always)]
fn plus(sum: [f64; 4], value: f64, b: &[f64; 4]) -> [f64; 4] {
    [sum[0] + value * b[0], sum[1] + value * b[1], sum[2] + value * b[2], sum[3] + value * b[3]]
}
