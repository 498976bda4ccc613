//! Processes that share a cache, and want the same results, take them in different orders: else each would wait for the other at
//! every one.

use equilux_formats::Result;
use std::hash::{DefaultHasher, Hash, Hasher};

/// The results for the numbers below `count`, in their order, made in an order of this process's own. Fails with the first error.
pub fn in_own_order<T>(count: usize, mut make: impl FnMut(usize) -> Result<T>) -> Result<Vec<T>> {
    let mut order: Vec<usize> = (0..count).collect();
    order.sort_by_cached_key(|&number| place(number));
    let mut made: Vec<Option<T>> = (0..count).map(|_| None).collect();
    for number in order {
        made[number] = Some(make(number)?);
    }
    Ok(made.into_iter().flatten().collect())
}

fn place(number: usize) -> u64 {
    let mut hasher = DefaultHasher::new();
    (std::process::id(), number).hash(&mut hasher);
    hasher.finish()
}
