//! A file of form factors to sources: a block, the identities of its senders, and which of them are near which receivers.

use super::rows::{Meta, read_rows, write_rows};
use super::{Stored, array_of, check};
use crate::container::{Kind, Reader, Writer};
use crate::error::Result;
use crate::fingerprint::Manifest;
use crate::source_rows::SourceRows;

impl Stored for SourceRows {
    const KIND: Kind = Kind::Sources;

    fn write(&self, manifest: &Manifest) -> Writer {
        let mut writer = Writer::new(Self::KIND, manifest, &Meta::of(&self.rows));
        writer.array("sources", &self.sources);
        let sizes: Vec<u32> = self.runs.iter().map(|run| run.len() as u32).collect();
        writer.array("sizes of runs", &sizes);
        writer.array("sources of runs", &self.runs.concat());
        write_rows(&self.rows, &mut writer);
        writer
    }

    fn read(reader: &mut Reader) -> Result<Self> {
        let meta: Meta = reader.meta()?;
        let sources: Vec<u64> = reader.array("sources")?;
        check(reader, sources.is_sorted_by(|a, b| a < b), || "sources that do not rise".into())?;
        let sizes: Vec<u32> = reader.array("sizes of runs")?;
        let total = sizes.iter().map(|&size| size as usize).sum();
        let all: Vec<u32> = array_of(reader, "sources of runs", total)?;
        let mut rest = all.as_slice();
        let mut run = |&size: &u32| {
            let (own, others) = rest.split_at(size as usize);
            rest = others;
            own.to_vec()
        };
        let runs: Vec<Vec<u32>> = sizes.iter().map(&mut run).collect();
        let count = sources.len();
        let is_run = |run: &Vec<u32>| {
            run.is_sorted_by(|a, b| a < b) && run.last().is_none_or(|&last| (last as usize) < count)
        };
        check(reader, runs.iter().all(is_run), || format!("runs that name other than {count} sources"))?;
        let rows = read_rows(reader, meta)?;
        check(reader, rows.senders() == count, || format!("rows of {} sources", rows.senders()))?;
        Ok(Self { sources, runs, rows })
    }
}
