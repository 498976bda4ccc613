//! One block of the form-factor matrix, by rows. Neighbouring receivers see the same senders, so rows come in groups
//! that share one list of columns.
//!
//! Row i holds F_ij = (1/π) ∫_{S_j} V cosθ_i cosθ_j / r² dy for the senders j that receiver i can see; a sender is an
//! element, or a cluster of elements (see [`crate::ClusterTree`]) whose form factor is as exact as an element's.

mod counted;
mod products;
mod row_sums;

use crate::rgb::Rgb;
pub use counted::CountedRow;
use counted::counted;
use products::products;
pub use row_sums::RowSumDefect;
use serde::{Deserialize, Serialize};

/// The precision of the stored numbers of a block.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum Precision {
    /// f64, as computed.
    Full,
    /// f32: the relative error of each entry and each sum of entries is at most [`SINGLE_ROUNDING`].
    Single,
    /// Whole numbers of rays, as counted.
    Counts,
}

/// Largest relative error of an entry stored as f32: half a unit in the last place.
pub const SINGLE_ROUNDING: f64 = f32::EPSILON as f64 / 2.0;

/// Rows of neighbouring receivers, from which blocks are built.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct RowGroup {
    /// The senders that any of the receivers sees.
    pub columns: Vec<u32>,
    /// Form factors, `receivers × columns`, by receiver.
    pub values: Vec<f64>,
    /// Number of receivers.
    pub receivers: usize,
}

/// A block of form factors, `receivers × senders`.
#[derive(Debug, Clone, PartialEq)]
pub struct Rows {
    senders: u32,
    groups: Vec<Extent>,
    columns: Vec<u32>,
    values: Values,
}

/// The start of a group.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Extent {
    receiver: usize,
    column: usize,
    value: usize,
}

#[derive(Debug, Clone, PartialEq)]
enum Values {
    Full(Vec<f64>),
    Single(Vec<f32>),
    /// Rays that end on each column, and for each row, which is a group of its own, the number of all its rays.
    Counts {
        counts: Vec<u16>,
        rays: Vec<u32>,
    },
}

/// A block as plain arrays: sizes of the groups, their columns, and the numbers in one of three forms.
#[derive(Default)]
pub(crate) struct Arrays<'a> {
    pub sizes: Vec<u32>,
    pub columns: &'a [u32],
    pub full: &'a [f64],
    pub single: &'a [f32],
    pub counts: &'a [u16],
    pub rays: &'a [u32],
}

/// The arrays of a block that was stored.
#[derive(Default)]
pub(crate) struct OwnedArrays {
    pub sizes: Vec<u32>,
    pub columns: Vec<u32>,
    pub full: Vec<f64>,
    pub single: Vec<f32>,
    pub counts: Vec<u16>,
    pub rays: Vec<u32>,
}

impl Rows {
    /// A block with `senders` columns from separate rows, each a list of (sender, form factor).
    pub fn from_rows(senders: usize, rows: impl IntoIterator<Item = Vec<(u32, f64)>>) -> Self {
        let group = |row: Vec<(u32, f64)>| {
            let (columns, values) = row.into_iter().unzip();
            RowGroup { columns, values, receivers: 1 }
        };
        Self::from_groups(senders, rows.into_iter().map(group), Precision::Full)
    }

    /// A block with `senders` columns from groups of rows, receivers in order.
    pub fn from_groups(
        senders: usize,
        groups: impl IntoIterator<Item = RowGroup>,
        precision: Precision,
    ) -> Self {
        let mut block = Self {
            senders: senders as u32,
            groups: vec![Extent { receiver: 0, column: 0, value: 0 }],
            columns: vec![],
            values: match precision {
                Precision::Full => Values::Full(vec![]),
                Precision::Single => Values::Single(vec![]),
                Precision::Counts => panic!("counted rows are made by from_counts"),
            },
        };
        for group in groups {
            block.push(group);
        }
        block
    }

    fn push(&mut self, group: RowGroup) {
        assert_eq!(
            group.values.len(),
            group.columns.len() * group.receivers,
            "a value a receiver and column"
        );
        assert!(group.columns.iter().all(|&c| c < self.senders), "a column past {} senders", self.senders);
        let end = self.groups[self.groups.len() - 1];
        self.groups.push(Extent {
            receiver: end.receiver + group.receivers,
            column: end.column + group.columns.len(),
            value: end.value + group.values.len(),
        });
        match &mut self.values {
            Values::Full(values) => values.extend_from_slice(&group.values),
            Values::Single(values) => values.extend(group.values.iter().map(|&value| value as f32)),
            Values::Counts { .. } => unreachable!("counted rows are not groups of numbers"),
        }
        self.columns.extend_from_slice(&group.columns);
    }

    /// Number of rows.
    pub fn receivers(&self) -> usize {
        self.groups[self.groups.len() - 1].receiver
    }

    /// Number of columns.
    pub fn senders(&self) -> usize {
        self.senders as usize
    }

    /// Number of stored form factors.
    pub fn stored(&self) -> usize {
        self.groups[self.groups.len() - 1].value
    }

    /// The precision of the numbers.
    pub fn precision(&self) -> Precision {
        match self.values {
            Values::Full(_) => Precision::Full,
            Values::Single(_) => Precision::Single,
            Values::Counts { .. } => Precision::Counts,
        }
    }

    /// Size of the block in memory, bytes.
    pub fn bytes(&self) -> usize {
        let values = match &self.values {
            Values::Full(values) => values.len() * 8,
            Values::Single(values) => values.len() * 4,
            Values::Counts { counts, rays } => counts.len() * 2 + rays.len() * 4,
        };
        self.groups.len() * size_of::<Extent>() + self.columns.len() * 4 + values
    }

    /// Upper bound of the relative rounding error of stored entries.
    pub fn rounding(&self) -> f64 {
        match self.precision() {
            Precision::Full | Precision::Counts => 0.0,
            Precision::Single => SINGLE_ROUNDING,
        }
    }

    /// Number of groups. Groups are independent, and contain all rows in order.
    pub fn groups(&self) -> usize {
        self.groups.len() - 1
    }

    /// The group that a receiver is in.
    pub fn group_of(&self, receiver: usize) -> usize {
        self.groups.partition_point(|g| g.receiver <= receiver) - 1
    }

    /// The columns of a group and its numbers, `receivers × columns`, by receiver.
    pub fn values_of(&self, group: usize) -> (&[u32], Vec<f64>) {
        let columns = self.columns_of(group);
        let first = self.groups[group].value;
        let end = first + self.receivers_of(group).len() * columns.len();
        let scale = self.scale_of(self.groups[group].receiver);
        (columns, (first..end).map(|index| self.value(index) * scale).collect())
    }

    /// The receivers of a group.
    pub fn receivers_of(&self, group: usize) -> std::ops::Range<usize> {
        self.groups[group].receiver..self.groups[group + 1].receiver
    }

    /// The (sender, form factor) pairs of one row that are not zero.
    pub fn row(&self, receiver: usize) -> impl Iterator<Item = (usize, f64)> + '_ {
        let columns = self.columns_of(self.group_of(receiver));
        let first = self.range_of(receiver).start;
        let scale = self.scale_of(receiver);
        let pairs =
            columns.iter().enumerate().map(move |(k, &c)| (c as usize, self.value(first + k) * scale));
        pairs.filter(|&(_, value)| value != 0.0)
    }

    /// The senders that any receiver sees, in no order and with repetitions.
    pub fn senders_seen(&self) -> impl Iterator<Item = usize> + '_ {
        self.columns.iter().map(|&column| column as usize)
    }

    /// Σ_j F_ij: the fraction of receiver i's hemisphere that the senders fill.
    pub fn row_sum(&self, receiver: usize) -> f64 {
        let range = self.range_of(receiver);
        match &self.values {
            Values::Full(values) => values[range].iter().sum(),
            Values::Single(values) => values[range].iter().map(|&value| f64::from(value)).sum(),
            // The sum of whole numbers first: a row whose rays all end on senders has exactly one.
            Values::Counts { counts, rays } => {
                let ended: u32 = counts[range].iter().map(|&count| u32::from(count)).sum();
                f64::from(ended) / f64::from(rays[receiver].max(1))
            }
        }
    }

    /// How far the row sums are from one.
    pub fn row_sum_defect(&self) -> RowSumDefect {
        RowSumDefect::of(&(0..self.receivers()).map(|i| self.row_sum(i)).collect::<Vec<_>>())
    }

    /// Number of form factors of one row that are not zero.
    pub fn entries_of(&self, receiver: usize) -> usize {
        let range = self.range_of(receiver);
        match &self.values {
            Values::Full(values) => values[range].iter().filter(|&&value| value != 0.0).count(),
            Values::Single(values) => values[range].iter().filter(|&&value| value != 0.0).count(),
            Values::Counts { .. } => range.len(),
        }
    }

    /// Where the numbers of a row are.
    fn range_of(&self, receiver: usize) -> std::ops::Range<usize> {
        let group = self.group_of(receiver);
        let width = self.columns_of(group).len();
        let first = self.groups[group].value + (receiver - self.groups[group].receiver) * width;
        first..first + width
    }

    /// Irradiance Σ_j F_ij B_j of a group's receivers, W/m², from the radiosity of all senders. The result has one entry
    /// a receiver of the group.
    pub fn gather_group(&self, group: usize, radiosity: &[Rgb]) -> Vec<Rgb> {
        let columns = self.columns_of(group);
        if let Values::Counts { counts, rays } = &self.values {
            let Extent { receiver, value, .. } = self.groups[group];
            return vec![counted(columns, &counts[value..value + columns.len()], rays[receiver], radiosity)];
        }
        let seen: Vec<Rgb> = columns.iter().map(|&c| radiosity[c as usize]).collect();
        let first = self.groups[group].value;
        let receivers = self.receivers_of(group);
        let range = first..first + receivers.len() * seen.len();
        match &self.values {
            Values::Full(values) => products(&values[range], &seen, receivers.len(), |&value| value),
            Values::Single(values) => {
                products(&values[range], &seen, receivers.len(), |&value| f64::from(value))
            }
            Values::Counts { .. } => unreachable!("counted rows have returned"),
        }
    }

    /// Σ_i w_i F_ij over a group's receivers i, for each sender j that any of them sees: the transposed block, for sums over
    /// receivers. One weight a receiver of the group.
    pub fn scatter_group<const N: usize>(
        &self,
        group: usize,
        weights: &[[f64; N]],
    ) -> Vec<(usize, [f64; N])> {
        let columns = self.columns_of(group);
        let first = self.groups[group].value;
        let mut sums = vec![[0.0; N]; columns.len()];
        for (row, weight) in weights.iter().enumerate() {
            let range = first + row * columns.len()..first + (row + 1) * columns.len();
            match &self.values {
                Values::Full(values) => spread(values[range].iter().copied(), weight, &mut sums),
                Values::Single(values) => {
                    spread(values[range].iter().map(|&value| f64::from(value)), weight, &mut sums);
                }
                Values::Counts { counts, .. } => {
                    let scale = self.scale_of(self.groups[group].receiver);
                    spread(counts[range].iter().map(|&count| f64::from(count) * scale), weight, &mut sums);
                }
            }
        }
        columns.iter().map(|&column| column as usize).zip(sums).collect()
    }

    fn columns_of(&self, group: usize) -> &[u32] {
        &self.columns[self.groups[group].column..self.groups[group + 1].column]
    }

    fn value(&self, index: usize) -> f64 {
        match &self.values {
            Values::Full(values) => values[index],
            Values::Single(values) => f64::from(values[index]),
            Values::Counts { counts, .. } => f64::from(counts[index]),
        }
    }

    /// What a stored number of a row is multiplied by to be a form factor.
    fn scale_of(&self, receiver: usize) -> f64 {
        match &self.values {
            Values::Full(_) | Values::Single(_) => 1.0,
            Values::Counts { rays, .. } => 1.0 / f64::from(rays[receiver].max(1)),
        }
    }

    pub(crate) fn arrays(&self) -> Arrays<'_> {
        let sizes = self
            .groups
            .windows(2)
            .flat_map(|g| [(g[1].receiver - g[0].receiver) as u32, (g[1].column - g[0].column) as u32]);
        let arrays = Arrays { sizes: sizes.collect(), columns: &self.columns, ..Arrays::default() };
        match &self.values {
            Values::Full(full) => Arrays { full, ..arrays },
            Values::Single(single) => Arrays { single, ..arrays },
            Values::Counts { counts, rays } => Arrays { counts, rays, ..arrays },
        }
    }

    pub(crate) fn from_arrays(
        senders: u32,
        precision: Precision,
        arrays: OwnedArrays,
    ) -> Result<Self, String> {
        let OwnedArrays { sizes, columns, full, single, counts, rays } = arrays;
        let (pairs, rest) = sizes.as_chunks::<2>();
        let mut groups = vec![Extent { receiver: 0, column: 0, value: 0 }];
        for &[receivers, width] in pairs {
            let end = groups[groups.len() - 1];
            groups.push(Extent {
                receiver: end.receiver + receivers as usize,
                column: end.column + width as usize,
                value: end.value + receivers as usize * width as usize,
            });
        }
        let end = groups[groups.len() - 1];
        let fits = match precision {
            Precision::Full => full.len() == end.value,
            Precision::Single => single.len() == end.value,
            Precision::Counts => {
                counts.len() == end.value && rays.len() == end.receiver && rays.len() == pairs.len()
            }
        };
        if !rest.is_empty() || !fits || columns.len() != end.column {
            return Err("rows whose groups do not fit their arrays".into());
        }
        if let Some(column) = columns.iter().find(|&&c| c >= senders) {
            return Err(format!("sender {column} of {senders}"));
        }
        let values = match precision {
            Precision::Full => Values::Full(full),
            Precision::Single => Values::Single(single),
            Precision::Counts => Values::Counts { counts, rays },
        };
        let block = Self { senders, groups, columns, values };
        // Sums of whole numbers have no rounding.
        match precision {
            Precision::Counts if (0..block.receivers()).any(|i| block.row_sum(i) > 1.0) => {
                Err("a row with more rays ended than started".into())
            }
            _ => Ok(block),
        }
    }
}

/// Adds a row's values, times its weight, to the sums of its columns.
fn spread<const N: usize>(row: impl Iterator<Item = f64>, weight: &[f64; N], sums: &mut [[f64; N]]) {
    for (value, sums) in row.zip(sums) {
        sums.iter_mut().zip(weight).for_each(|(sum, weight)| *sum += value * weight);
    }
}
