//! One block of the form-factor matrix, by rows. Neighbouring receivers see the same senders, so rows come in groups
//! that share one list of columns.
//!
//! Row i holds F_ij = (1/π) ∫_{S_j} V cosθ_i cosθ_j / r² dy for the senders j that receiver i can see; a sender is an
//! element, or a cluster of elements (see [`crate::ClusterTree`]) whose form factor is as exact as an element's.

mod products;

use products::products;
use serde::{Deserialize, Serialize};

/// Red, green, blue; linear, BT.709 primaries.
pub type Rgb = [f64; 3];

/// How the numbers of a block are kept.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum Precision {
    /// f64, as computed.
    Full,
    /// Whole steps of 1/65535 of the row's largest entry. What rounding takes from one entry it gives to the next, so
    /// that the row's sum is kept to one step.
    Steps,
}

/// Rows of neighbouring receivers before they go into a block.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct RowGroup {
    /// The senders that any of the receivers sees.
    pub columns: Vec<u32>,
    /// Form factors, `receivers × columns`, by receiver.
    pub values: Vec<f64>,
    /// Number of receivers.
    pub receivers: usize,
    /// Steps to keep the numbers in, one a receiver, if they were kept in these before; without any, what suits each row.
    pub steps: Option<Vec<f64>>,
}

/// A block of exact form factors, `receivers × senders`.
#[derive(Debug, Clone, PartialEq)]
pub struct Rows {
    senders: u32,
    groups: Vec<Extent>,
    columns: Vec<u32>,
    values: Values,
}

/// Where a group begins.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Extent {
    receiver: usize,
    column: usize,
    value: usize,
}

#[derive(Debug, Clone, PartialEq)]
enum Values {
    Full(Vec<f64>),
    Steps { steps: Vec<u16>, unit: Vec<f64> },
}

/// A block as plain arrays: sizes of the groups, their columns, and the numbers in one of two forms.
pub(crate) struct Arrays<'a> {
    pub sizes: Vec<u32>,
    pub columns: &'a [u32],
    pub full: &'a [f64],
    pub steps: &'a [u16],
    pub units: &'a [f64],
}

impl Rows {
    /// A block with `senders` columns from rows that share nothing, each a list of (sender, form factor).
    pub fn from_rows(senders: usize, rows: impl IntoIterator<Item = Vec<(u32, f64)>>) -> Self {
        let group = |row: Vec<(u32, f64)>| {
            let (columns, values) = row.into_iter().unzip();
            RowGroup { columns, values, receivers: 1, steps: None }
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
                Precision::Steps => Values::Steps { steps: vec![], unit: vec![] },
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
            Values::Steps { steps, unit } => {
                for receiver in 0..group.receivers {
                    let row = &group.values[receiver * group.columns.len()..][..group.columns.len()];
                    let before = group.steps.as_ref().map(|before| before[receiver]);
                    unit.push(quantise(row, before, steps));
                }
            }
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

    /// How the numbers are kept.
    pub fn precision(&self) -> Precision {
        match self.values {
            Values::Full(_) => Precision::Full,
            Values::Steps { .. } => Precision::Steps,
        }
    }

    /// Bytes the block takes in memory.
    pub fn bytes(&self) -> usize {
        let values = match &self.values {
            Values::Full(values) => values.len() * 8,
            Values::Steps { steps, unit } => steps.len() * 2 + unit.len() * 8,
        };
        self.groups.len() * size_of::<Extent>() + self.columns.len() * 4 + values
    }

    /// No entry of a row is further than this from what was computed: a step, or nothing.
    pub fn step_of(&self, receiver: usize) -> f64 {
        match &self.values {
            Values::Full(_) => 0.0,
            Values::Steps { unit, .. } => unit[receiver],
        }
    }

    /// Number of groups; groups are independent and together give all rows in order.
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
        let row = |(k, receiver): (usize, usize)| {
            let from = first + k * columns.len();
            (from..from + columns.len()).map(move |index| self.value(index, receiver))
        };
        (columns, self.receivers_of(group).enumerate().flat_map(row).collect())
    }

    /// The receivers of a group.
    pub fn receivers_of(&self, group: usize) -> std::ops::Range<usize> {
        self.groups[group].receiver..self.groups[group + 1].receiver
    }

    /// The (sender, form factor) pairs of one row that are not zero.
    pub fn row(&self, receiver: usize) -> impl Iterator<Item = (usize, f64)> + '_ {
        let columns = self.columns_of(self.group_of(receiver));
        let first = self.range_of(receiver).start;
        let pairs =
            columns.iter().enumerate().map(move |(k, &c)| (c as usize, self.value(first + k, receiver)));
        pairs.filter(|&(_, value)| value != 0.0)
    }

    /// The senders that any receiver sees, in no order, some of them often; with them those that are too small for a step.
    pub fn senders_seen(&self) -> impl Iterator<Item = usize> + '_ {
        self.columns.iter().map(|&column| column as usize)
    }

    /// Σ_j F_ij: the fraction of receiver i's view that the senders fill.
    pub fn row_sum(&self, receiver: usize) -> f64 {
        let range = self.range_of(receiver);
        match &self.values {
            Values::Full(values) => values[range].iter().sum(),
            Values::Steps { steps, unit } => {
                steps[range].iter().map(|&step| u64::from(step)).sum::<u64>() as f64 * unit[receiver]
            }
        }
    }

    /// Number of form factors of one row that are not zero.
    pub fn entries_of(&self, receiver: usize) -> usize {
        let range = self.range_of(receiver);
        match &self.values {
            Values::Full(values) => values[range].iter().filter(|&&value| value != 0.0).count(),
            Values::Steps { steps, .. } => steps[range].iter().filter(|&&step| step != 0).count(),
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
        let seen: Vec<Rgb> = columns.iter().map(|&c| radiosity[c as usize]).collect();
        let first = self.groups[group].value;
        let receivers = self.receivers_of(group);
        let range = first..first + receivers.len() * seen.len();
        match &self.values {
            Values::Full(values) => products(&values[range], &seen, receivers.len(), |&value| value),
            Values::Steps { steps, unit } => {
                let mut sums = products(&steps[range], &seen, receivers.len(), |&step| f64::from(step));
                sums.iter_mut().zip(&unit[receivers]).for_each(|(sum, unit)| *sum = sum.map(|s| s * unit));
                sums
            }
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
        for (row, (receiver, weight)) in self.receivers_of(group).zip(weights).enumerate() {
            let range = first + row * columns.len()..first + (row + 1) * columns.len();
            match &self.values {
                Values::Full(values) => spread(values[range].iter().copied(), weight, &mut sums),
                Values::Steps { steps, unit } => {
                    let unit = unit[receiver];
                    spread(steps[range].iter().map(|&s| f64::from(s) * unit), weight, &mut sums);
                }
            }
        }
        columns.iter().map(|&column| column as usize).zip(sums).collect()
    }

    fn columns_of(&self, group: usize) -> &[u32] {
        &self.columns[self.groups[group].column..self.groups[group + 1].column]
    }

    fn value(&self, index: usize, receiver: usize) -> f64 {
        match &self.values {
            Values::Full(values) => values[index],
            Values::Steps { steps, unit } => f64::from(steps[index]) * unit[receiver],
        }
    }

    pub(crate) fn arrays(&self) -> Arrays<'_> {
        let sizes = self
            .groups
            .windows(2)
            .flat_map(|g| [(g[1].receiver - g[0].receiver) as u32, (g[1].column - g[0].column) as u32]);
        let (full, steps, units): (&[f64], &[u16], &[f64]) = match &self.values {
            Values::Full(values) => (values, &[], &[]),
            Values::Steps { steps, unit } => (&[], steps, unit),
        };
        Arrays { sizes: sizes.collect(), columns: &self.columns, full, steps, units }
    }

    pub(crate) fn from_arrays(
        senders: u32,
        precision: Precision,
        sizes: &[u32],
        columns: Vec<u32>,
        numbers: (Vec<f64>, Vec<u16>, Vec<f64>),
    ) -> Result<Self, String> {
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
        let (full, steps, unit) = numbers;
        let values = match precision {
            Precision::Full => Values::Full(full),
            Precision::Steps => Values::Steps { steps, unit },
        };
        let fits = match &values {
            Values::Full(values) => values.len() == end.value,
            Values::Steps { steps, unit } => steps.len() == end.value && unit.len() == end.receiver,
        };
        if !rest.is_empty() || !fits || columns.len() != end.column {
            return Err("rows whose groups do not fit their arrays".into());
        }
        if let Some(column) = columns.iter().find(|&&c| c >= senders) {
            return Err(format!("sender {column} of {senders}"));
        }
        Ok(Self { senders, groups, columns, values })
    }
}

/// Add a row's values times its weights to the sums of its columns.
fn spread<const N: usize>(row: impl Iterator<Item = f64>, weight: &[f64; N], sums: &mut [[f64; N]]) {
    for (value, sums) in row.zip(sums) {
        sums.iter_mut().zip(weight).for_each(|(sum, weight)| *sum += value * weight);
    }
}

/// A step of an earlier row does if it is at most this much coarser than needed.
const COARSER: f64 = 4.0;

/// Append the row in steps of its largest entry; returns the size of a step. The error of each entry goes into the
/// next (first-order noise shaping), so that partial sums are never off by more than half a step. Numbers that were kept
/// in steps before stay what they are if that step still does.
fn quantise(row: &[f64], before: Option<f64>, steps: &mut Vec<u16>) -> f64 {
    let suits = row.iter().copied().fold(0.0, f64::max) / f64::from(u16::MAX);
    let unit = before.filter(|&before| before >= suits && before <= COARSER * suits).unwrap_or(suits);
    let mut carried = 0.0;
    for &value in row {
        let wanted = if unit > 0.0 { value / unit + carried } else { 0.0 };
        let step = if value > 0.0 { wanted.round().clamp(0.0, f64::from(u16::MAX)) } else { 0.0 };
        if value > 0.0 {
            carried = wanted - step;
        }
        steps.push(step as u16);
    }
    unit
}
