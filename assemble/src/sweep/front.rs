//! The Pareto front: which of many choices are worth making.

/// The numbers of the choices that no other beats, by falling second value: whatever costs no more than one of these errs
/// more, or it is one of them. In go pairs such as (seconds, error); of equal ones the first counts. What is no number is
/// never chosen.
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
