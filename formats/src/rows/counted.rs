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
    let mut sum = [0.0; 3];
    for (&column, &count) in columns.iter().zip(counts) {
        let Rgb([r, g, b]) = radiosity[column as usize];
        let count = f64::from(count);
        sum = [sum[0] + count * r, sum[1] + count * g, sum[2] + count * b];
    }
    Rgb(sum) / f64::from(rays.max(1))
}
