//! Composes a file in memory and writes it.

use super::{ArrayEntry, Index, Kind, Number, checksum, frame, header};
use crate::error::{Error, Result};
use crate::fingerprint::Manifest;
use crate::whole_file::write_whole;
use serde::Serialize;
use std::io;
use std::path::Path;

/// A file under construction in memory.
#[derive(Debug)]
pub struct Writer {
    kind: Kind,
    index: Index,
    meta: Vec<u8>,
    frames: Vec<u8>,
}

impl Writer {
    /// A file of `kind` with the inputs in `manifest` and further metadata in `meta`.
    pub fn new(kind: Kind, manifest: &Manifest, meta: &impl Serialize) -> Self {
        let meta = rmp_serde::to_vec_named(meta).expect("metadata are plain data");
        Self { kind, index: Index { manifest: manifest.clone(), arrays: vec![] }, meta, frames: vec![] }
    }

    /// Adds an array. Panics when the name is taken.
    pub fn array<T: Number>(&mut self, name: &str, values: &[T]) {
        assert!(self.index.arrays.iter().all(|entry| entry.name != name), "two arrays named {name:?}");
        let frame =
            frame::compress(bytemuck::cast_slice(values)).expect("compressing into memory cannot fail");
        self.index.arrays.push(ArrayEntry {
            name: name.into(),
            number: T::NAME.into(),
            count: values.len() as u64,
            length: frame.len() as u64,
            checksum: *blake3::hash(&frame).as_bytes(),
        });
        self.frames.extend(frame);
    }

    /// Writes the file to `path` atomically: readers see the old file or the whole new one, and a failure leaves
    /// nothing behind. The file is not flushed to disk: after a power failure the checksums detect lost data.
    pub fn write_to(&self, path: &Path) -> Result<()> {
        self.try_write_to(path).map_err(|error| {
            Error::new(
                path,
                format!("could not be written ({error})"),
                "a writable folder with enough room",
                "make room or choose another folder with --cache DIR",
            )
        })
    }

    fn try_write_to(&self, path: &Path) -> io::Result<()> {
        let mut messages = rmp_serde::to_vec_named(&self.index).expect("the index is plain data");
        messages.extend(&self.meta);
        let header = header(self.kind.code(), messages.len() as u64);

        write_whole(path, |file| {
            file.write_all(&header)?;
            file.write_all(&checksum(&header, &messages))?;
            file.write_all(&messages)?;
            file.write_all(&self.frames)
        })
    }
}
