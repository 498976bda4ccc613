//! Rows of counted rays: whole numbers k_ij over the number of a row's rays.

use super::{Extent, Rows, Values};
use crate::rgb::Rgb;

/// A row of counted rays, from which blocks are built.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct CountedRow {
    /// Senders and the rays that end on them.
    pub counts: Vec<(u32, u16)>,
    /// The number of rays that the row's form factors are shares of.
    pub rays: u32,
}

/// In place of the number of a row's rays: the row is that of another block.
const AS_BEFORE: u32 = u32::MAX;

impl Rows {
    /// A block with `senders` columns from counted rows, receivers in order.
    pub fn from_counts(senders: usize, rows: impl IntoIterator<Item = CountedRow>) -> Self {
        let mut groups = vec![Extent { receiver: 0, column: 0, value: 0 }];
        let (mut columns, mut counts, mut rays) = (vec![], vec![], vec![]);
        for row in rows {
            for (column, count) in row.counts {
                assert!((column as usize) < senders, "a column past {senders} senders");
                columns.push(column);
                counts.push(count);
            }
            rays.push(row.rays);
            groups.push(Extent { receiver: rays.len(), column: columns.len(), value: columns.len() });
        }
        Self { senders: senders as u32, groups, columns, values: Values::Counts { counts, rays } }
    }

    /// A row of counted rays. Panics if rows are not counted.
    pub fn counted_row(&self, receiver: usize) -> CountedRow {
        let Values::Counts { counts, rays } = &self.values else { panic!("rows are not counted") };
        let counts = counts[self.range_of(receiver)].iter().copied();
        let columns = self.columns_of(receiver).iter().copied();
        CountedRow { counts: columns.zip(counts).collect(), rays: rays[receiver] }
    }

    /// The number of rays that a row's form factors are shares of, as a share of `rays`; 1 if rows are not counted.
    pub fn share_of_rays(&self, receiver: usize, rays: u32) -> f64 {
        match &self.values {
            Values::Counts { rays: of, .. } => f64::from(of[receiver]) / f64::from(rays),
            Values::Full(_) | Values::Single(_) => 1.0,
        }
    }

    /// What differs from another block of as many counted rows: these rows, and a mark in place of each equal one.
    pub fn changes_from(&self, before: &Self) -> Self {
        let row = |receiver| {
            let row = self.counted_row(receiver);
            let is_equal = row == before.counted_row(receiver);
            if is_equal { CountedRow { counts: vec![], rays: AS_BEFORE } } else { row }
        };
        Self::from_counts(self.senders(), (0..self.receivers()).map(row))
    }

    /// `before` with these changes, as [`Self::changes_from`] finds them; none if there are no changes.
    pub fn applied_to(&self, before: &Self) -> Option<Self> {
        let Values::Counts { rays, .. } = &self.values else { panic!("rows are not counted") };
        if rays.iter().all(|&rays| rays == AS_BEFORE) {
            return None;
        }
        let from = |receiver: usize| if rays[receiver] == AS_BEFORE { before } else { self };
        let rows = (0..self.receivers()).map(|receiver| from(receiver).counted_row(receiver));
        Some(Self::from_counts(self.senders(), rows))
    }

    /// The columns before `column`, and those from it on, as two blocks of counted rows. Panics if rows are not counted.
    pub fn parted(&self, column: usize) -> [Self; 2] {
        let rows: Vec<CountedRow> = (0..self.receivers()).map(|row| self.counted_row(row)).collect();
        let first = |row: &CountedRow| row.counts.partition_point(|&(c, _)| (c as usize) < column);
        let before = rows.iter().map(|row| CountedRow { counts: row.counts[..first(row)].to_vec(), ..*row });
        let moved = |&(c, count): &(u32, u16)| (c - column as u32, count);
        let after = rows.iter().map(|row| {
            let counts = row.counts[first(row)..].iter().map(moved).collect();
            CountedRow { counts, ..*row }
        });
        [Self::from_counts(column, before), Self::from_counts(self.senders() - column, after)]
    }
}

/// The irradiance of a counted row, W/m²: Σ_j k_ij B_j over the number of its rays.
pub(super) fn counted(columns: &[u32], counts: &[u16], rays: u32, radiosity: &[Rgb]) -> Rgb {
    // Several sums at once, since each addition waits for the last of its sum.
    let mut sums = [[0.0; 3]; SUMS];
    let ((columns, last_columns), (counts, last_counts)) =
        (columns.as_chunks::<SUMS>(), counts.as_chunks::<SUMS>());
    for (columns, counts) in columns.iter().zip(counts) {
        for k in 0..SUMS {
            add(&mut sums[k], counts[k], radiosity[columns[k] as usize]);
        }
    }
    for (&column, &count) in last_columns.iter().zip(last_counts) {
        add(&mut sums[0], count, radiosity[column as usize]);
    }
    let sum = sums.into_iter().fold(Rgb::BLACK, |all, sum| all + Rgb(sum));
    sum / f64::from(rays.max(1))
}

/// Sums of a row at once.
const SUMS: usize = 4;

fn add(sum: &mut [f64; 3], count: u16, Rgb(radiosity): Rgb) {
    let count = f64::from(count);
    sum.iter_mut().zip(radiosity).for_each(|(sum, radiosity)| *sum += count * radiosity);
}
