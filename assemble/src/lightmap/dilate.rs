//! Extends light to the texels around a chart, so that lookups near its edge return no dark texels: each gets the
//! mean of its lit neighbours. Only texels of the chart's own rectangle take part.

use super::grid::MARGIN;
use equilux_formats::Rgb;

/// Fill empty texels within [`MARGIN`] texels of lit ones. `values`: one for each texel, row after row of `width`.
pub fn dilate(values: &mut [Option<Rgb>], width: u32) {
    for _ in 0..MARGIN {
        let before = values.to_vec();
        for (index, value) in values.iter_mut().enumerate().filter(|(_, value)| value.is_none()) {
            *value = mean(neighbours(index, width as usize, before.len()).filter_map(|i| before[i]));
        }
    }
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
