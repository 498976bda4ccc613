//! Blocks of rows, receivers side by side on all threads. A row does not depend on which thread computes it.

use super::row::row;
use crate::monitor::Monitor;
use crate::world::World;
use equilux_formats::Rows;
use rayon::prelude::*;
use std::ops::Range;
use std::time::{Duration, Instant};

/// A block and the time that all threads together spent on it.
pub struct Timed {
    /// The form factors, `receivers × senders`.
    pub block: Rows,
    /// Sum over the rows.
    pub time: Duration,
}

/// Form factors from `receivers` to every sender in `senders`, which are ranges of elements of `world`; columns are
/// counted from the beginning of `columns`. None if the monitor was stopped.
pub fn block(
    world: &World,
    receivers: Range<usize>,
    senders: &[Range<usize>],
    columns: Range<usize>,
    monitor: &Monitor,
) -> Option<Timed> {
    let rows: Vec<(Vec<(u32, f64)>, Duration)> = receivers
        .into_par_iter()
        .map(|receiver| {
            let start = Instant::now();
            let mut all = Vec::new();
            if !monitor.stopped() {
                for range in senders {
                    let offset = (range.start - columns.start) as u32;
                    all.extend(row(world, receiver, range.clone()).into_iter().map(|(s, f)| (s + offset, f)));
                }
            }
            monitor.advance(1);
            (all, start.elapsed())
        })
        .collect();
    if monitor.stopped() {
        return None;
    }
    let time = rows.iter().map(|(_, time)| *time).sum();
    Some(Timed { block: Rows::from_rows(columns.len(), rows.into_iter().map(|(row, _)| row)), time })
}
