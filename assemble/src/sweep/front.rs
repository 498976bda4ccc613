//! The Pareto front: the choices that no other choice beats in both cost and error.

/// The indices of the (cost, error) pairs on the front, by rising cost and falling error: any other choice that costs no
/// more than one of these has a larger error. Of equal pairs the first counts. A pair with a NaN is never chosen.
pub fn front(choices: &[(f64, f64)]) -> Vec<usize> {
    let mut order: Vec<usize> = (0..choices.len())
        .filter(|&choice| !choices[choice].0.is_nan() && !choices[choice].1.is_nan())
        .collect();
    order.sort_by(|&a, &b| {
        choices[a].0.total_cmp(&choices[b].0).then(choices[a].1.total_cmp(&choices[b].1)).then(a.cmp(&b))
    });
    let mut least = f64::INFINITY;
    order.retain(|&choice| {
        let better = choices[choice].1 < least;
        least = least.min(choices[choice].1);
        better
    });
    order
}
