//! The arrays of one block of form factors, and the coupling file, which is one block.

use super::{Stored, finite_array};
use crate::container::{Kind, Reader, Writer};
use crate::error::Result;
use crate::fingerprint::Manifest;
use crate::rows::Rows;
use serde::{Deserialize, Serialize};

#[derive(Serialize, Deserialize)]
struct Meta {
    senders: u32,
}

impl Stored for Rows {
    const KIND: Kind = Kind::Coupling;

    fn write(&self, manifest: &Manifest) -> Writer {
        let mut writer = Writer::new(Self::KIND, manifest, &Meta { senders: self.senders() as u32 });
        write_rows(self, &mut writer);
        writer
    }

    fn read(reader: &mut Reader) -> Result<Self> {
        let Meta { senders } = reader.meta()?;
        read_rows(reader, senders)
    }
}

/// The arrays of `rows`; how many senders there are is for the caller to note.
pub(super) fn write_rows(rows: &Rows, writer: &mut Writer) {
    let (starts, columns, values) = rows.arrays();
    writer.array("row starts", starts);
    writer.array("columns", columns);
    writer.array("form factors", values);
}

/// The block that [`write_rows`] wrote.
pub(super) fn read_rows(reader: &mut Reader, senders: u32) -> Result<Rows> {
    let starts = reader.array("row starts")?;
    let columns = reader.array("columns")?;
    let values = finite_array(reader, "form factors")?;
    Rows::from_arrays(senders, starts, columns, values).map_err(|problem| reader.damaged(problem))
}
