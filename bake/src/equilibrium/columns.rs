//! A block of form factors by columns, for solvers that shoot light instead of gathering it.

use equilux_formats::Rows;

/// A block by columns: for each sender the receivers that see it.
#[derive(Debug)]
pub struct Columns {
    starts: Vec<usize>,
    entries: Vec<(u32, f64)>,
}

impl Columns {
    /// The transpose of `block`.
    pub fn of(block: &Rows) -> Self {
        let n = block.receivers();
        let mut starts = vec![0; block.senders() + 1];
        (0..n).flat_map(|i| block.row(i)).for_each(|(j, _)| starts[j + 1] += 1);
        for j in 0..block.senders() {
            starts[j + 1] += starts[j];
        }
        let mut next = starts.clone();
        let mut entries = vec![(0, 0.0); block.stored()];
        for i in 0..n {
            for (j, value) in block.row(i) {
                entries[next[j]] = (i as u32, value);
                next[j] += 1;
            }
        }
        Self { starts, entries }
    }

    /// The receivers that see `sender`, with their form factors.
    pub fn column(&self, sender: usize) -> &[(u32, f64)] {
        &self.entries[self.starts[sender]..self.starts[sender + 1]]
    }
}
