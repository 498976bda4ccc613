//! The arrays of one block of form factors, and the coupling file, which is one block.

use super::{Stored, finite_array};
use crate::container::{Kind, Reader, Writer};
use crate::error::Result;
use crate::fingerprint::Manifest;
use crate::rows::{OwnedArrays, Precision, Rows};
use serde::{Deserialize, Serialize};

/// The metadata of a block.
#[derive(Serialize, Deserialize)]
pub(super) struct Meta {
    senders: u32,
    precision: Precision,
}

impl Meta {
    pub(super) fn of(rows: &Rows) -> Self {
        Self { senders: rows.senders() as u32, precision: rows.precision() }
    }
}

impl Stored for Rows {
    const KIND: Kind = Kind::Coupling;

    fn write(&self, manifest: &Manifest) -> Writer {
        let mut writer = Writer::new(Self::KIND, manifest, &Meta::of(self));
        write_rows(self, &mut writer);
        writer
    }

    fn read(reader: &mut Reader) -> Result<Self> {
        let meta = reader.meta()?;
        read_rows(reader, meta)
    }
}

/// Writes the arrays of `rows` and returns its [`Meta`]. Columns of a group are close together, so their differences
/// compress better.
pub(super) fn write_rows(rows: &Rows, writer: &mut Writer) {
    let arrays = rows.arrays();
    let mut last = 0;
    let differences: Vec<u32> = arrays
        .columns
        .iter()
        .map(|&column| column.wrapping_sub(std::mem::replace(&mut last, column)))
        .collect();
    writer.array("group sizes", &arrays.sizes);
    writer.array("column differences", &differences);
    writer.array("form factors", arrays.full);
    writer.array("single form factors", arrays.single);
    writer.array("counted rays", arrays.counts);
    writer.array("rays of rows", arrays.rays);
}

/// The block that [`write_rows`] wrote.
pub(super) fn read_rows(reader: &mut Reader, meta: Meta) -> Result<Rows> {
    let sizes: Vec<u32> = reader.array("group sizes")?;
    let mut columns: Vec<u32> = reader.array("column differences")?;
    let mut last = 0u32;
    for column in &mut columns {
        last = last.wrapping_add(*column);
        *column = last;
    }
    let full = finite_array(reader, "form factors")?;
    let single = finite_array(reader, "single form factors")?;
    let (counts, rays) = (reader.array("counted rays")?, reader.array("rays of rows")?);
    let arrays = OwnedArrays { sizes, columns, full, single, counts, rays };
    Rows::from_arrays(meta.senders, meta.precision, arrays).map_err(|problem| reader.damaged(problem))
}
