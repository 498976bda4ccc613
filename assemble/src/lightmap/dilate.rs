//! Extends light over a chart's rectangle: to texels that something covers, so that lookups beside them mix in no black, and to
//! those around the chart, for lookups near its edge and in smaller images. Each gets the mean of its neighbours that are nearer
//! to the light. Only texels of the chart's own rectangle take part.

use equilux_formats::Rgb;

/// The distance of texels that nothing was extended to.
pub const NEVER: u32 = u32::MAX;

/// Fill empty texels from those with a value for which `extends` holds. `values`: one for each texel, row after row of `width`.
/// Returns how many texels each is away from the value that it has: 0 for its own, [`NEVER`] if it is still empty.
pub fn dilate(values: &mut [Option<Rgb>], width: u32, extends: impl Fn(Rgb) -> bool) -> Vec<u32> {
    let mut distances: Vec<u32> =
        values.iter().map(|value| if value.is_some() { 0 } else { NEVER }).collect();
    let sends = |value: Option<Rgb>| value.filter(|&value| extends(value));
    let around = |index: usize| neighbours(index, width as usize, values.len());
    let is_edge = |&index: &usize| {
        sends(values[index]).is_some() && around(index).any(|beside| values[beside].is_none())
    };
    let mut ring: Vec<usize> = (0..values.len()).filter(is_edge).collect();
    let mut distance = 0;
    while !ring.is_empty() {
        distance += 1;
        let width = width as usize;
        let mut next: Vec<usize> =
            ring.iter().flat_map(|&index| neighbours(index, width, distances.len())).collect();
        next.retain(|&index| distances[index] == NEVER);
        next.sort_unstable();
        next.dedup();
        let nearer = |index: usize| {
            let known = neighbours(index, width, distances.len()).filter(|&i| distances[i] < distance);
            mean(known.filter_map(|i| if distances[i] == 0 { sends(values[i]) } else { values[i] }))
        };
        let found: Vec<Option<Rgb>> = next.iter().map(|&index| nearer(index)).collect();
        for (&index, value) in next.iter().zip(found) {
            (values[index], distances[index]) = (value, distance);
        }
        ring = next;
    }
    distances
}

fn neighbours(index: usize, width: usize, count: usize) -> impl Iterator<Item = usize> {
    let (column, row) = (index % width, index / width);
    let rows = row.saturating_sub(1)..(row + 2).min(count / width);
    let columns = move || column.saturating_sub(1)..(column + 2).min(width);
    rows.flat_map(move |row| columns().map(move |column| row * width + column))
}

fn mean(values: impl Iterator<Item = Rgb>) -> Option<Rgb> {
    let (mut sum, mut count) = (Rgb::BLACK, 0.0);
    for value in values {
        sum.iter_mut().zip(value).for_each(|(sum, v)| *sum += v);
        count += 1.0;
    }
    (count > 0.0).then(|| sum / count)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        /// Distances are those of a king on a board, and values lie between those that are nearest.
        #[test]
        fn empty_texels_get_the_nearest_values(lit in prop::collection::vec((0..9_usize, 0..7_usize, 1..9_u32), 1..6)) {
            let mut values = vec![None; 9 * 7];
            lit.iter().for_each(|&(x, y, h)| values[y * 9 + x] = Some(Rgb::splat(f64::from(h))));
            let before = values.clone();
            let distances = dilate(&mut values, 9, |_| true);
            for (index, (value, &distance)) in values.iter().zip(&distances).enumerate() {
                let away = |&(x, y, _): &(usize, usize, u32)| (index % 9).abs_diff(x).max((index / 9).abs_diff(y));
                let least = lit.iter().map(away).min().expect("one is lit");
                prop_assert_eq!(distance as usize, least);
                let [low, high] = [f64::min, f64::max].map(|pick: fn(f64, f64) -> f64| {
                    before.iter().flatten().map(|h| h[0]).reduce(pick).expect("one is lit")
                });
                let value = value.expect("all are filled")[0];
                prop_assert!((low..=high).contains(&value), "{value} from {low} to {high}");
            }
        }
    }

    /// A strip of light, covered texels, and darkness: light goes under the cover, darkness keeps its own texels.
    #[test]
    fn covered_texels_take_light_and_no_darkness() {
        let dark = Some(Rgb::BLACK);
        let mut values = [Some(Rgb::WHITE), None, None, None, dark, dark];
        dilate(&mut values, 6, |value| value != Rgb::BLACK);
        assert_eq!(values.map(|value| value.map(|v| v[0])), [1.0, 1.0, 1.0, 1.0, 0.0, 0.0].map(Some));
    }
}
