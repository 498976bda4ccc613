//! One block of the form-factor matrix, by rows; only what is not zero is kept.
//!
//! Row i holds F_ij = (1/π) ∫_{S_j} V cosθ_i cosθ_j / r² dy for the senders j that receiver i can see.

use serde::{Deserialize, Serialize};

/// Red, green, blue; linear, BT.709 primaries.
pub type Rgb = [f64; 3];

/// A block of exact form factors, `receivers × senders`, compressed sparse rows.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Rows {
    senders: u32,
    /// Where each row begins in `columns` and `values`; one more than there are rows.
    starts: Vec<u64>,
    columns: Vec<u32>,
    values: Vec<f64>,
}

impl Rows {
    /// A block with `senders` columns from its rows, each a list of (sender, form factor) by rising sender.
    pub fn from_rows(senders: usize, rows: impl IntoIterator<Item = Vec<(u32, f64)>>) -> Self {
        let mut block = Self { senders: senders as u32, starts: vec![0], ..Self::default() };
        for row in rows {
            for (column, value) in row {
                assert!((column as usize) < senders, "sender {column} of {senders}");
                block.columns.push(column);
                block.values.push(value);
            }
            block.starts.push(block.columns.len() as u64);
        }
        block
    }

    /// A block from its three arrays as [`Rows::arrays`] gives them, or what is wrong with them.
    pub(crate) fn from_arrays(
        senders: u32,
        starts: Vec<u64>,
        columns: Vec<u32>,
        values: Vec<f64>,
    ) -> Result<Self, String> {
        if columns.len() != values.len() {
            return Err(format!("{} columns for {} form factors", columns.len(), values.len()));
        }
        if starts.first() != Some(&0) || starts.last() != Some(&(values.len() as u64)) || !starts.is_sorted()
        {
            return Err(format!("rows that do not divide {} form factors", values.len()));
        }
        match columns.iter().find(|&&column| column >= senders) {
            Some(column) => Err(format!("sender {column} of {senders}")),
            None => Ok(Self { senders, starts, columns, values }),
        }
    }

    /// Where each row begins (and the last ends), the columns, and the values.
    pub(crate) fn arrays(&self) -> (&[u64], &[u32], &[f64]) {
        (&self.starts, &self.columns, &self.values)
    }

    /// Number of rows.
    pub fn receivers(&self) -> usize {
        self.starts.len() - 1
    }

    /// Number of columns.
    pub fn senders(&self) -> usize {
        self.senders as usize
    }

    /// Number of stored form factors.
    pub fn stored(&self) -> usize {
        self.values.len()
    }

    /// Bytes the block takes in memory.
    pub fn bytes(&self) -> usize {
        self.starts.len() * 8 + self.stored() * 12
    }

    /// The (sender, form factor) pairs of one row.
    pub fn row(&self, receiver: usize) -> impl Iterator<Item = (usize, f64)> + '_ {
        let range = self.starts[receiver] as usize..self.starts[receiver + 1] as usize;
        self.columns[range.clone()].iter().map(|&c| c as usize).zip(self.values[range].iter().copied())
    }

    /// Σ_j F_ij: the fraction of receiver i's view that the senders fill.
    pub fn row_sum(&self, receiver: usize) -> f64 {
        self.row(receiver).map(|(_, value)| value).sum()
    }

    /// Σ_j F_ij B_j: the irradiance that senders of radiosity `radiosity` cause at one receiver, W/m².
    pub fn gather(&self, receiver: usize, radiosity: &[Rgb]) -> Rgb {
        let mut sum = [0.0; 3];
        for (sender, value) in self.row(receiver) {
            let b = &radiosity[sender];
            for channel in 0..3 {
                sum[channel] += value * b[channel];
            }
        }
        sum
    }
}
