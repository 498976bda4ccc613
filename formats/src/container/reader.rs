//! Reads and validates files.

use super::{
    ArrayEntry, FORMAT_VERSION, HEADER_LENGTH, Index, Kind, MAGIC, MESSAGES_LIMIT, Number, checksum, frame,
};
use crate::error::{Error, Result};
use crate::fingerprint::Manifest;
use serde::de::DeserializeOwned;
use std::fs::File;
use std::io::{self, Read, Seek, SeekFrom};
use std::path::{Path, PathBuf};

/// A file with valid header and messages. Arrays are read and verified one at a time.
#[derive(Debug)]
pub struct Reader {
    source: Source,
    index: Index,
    meta: Vec<u8>,
    /// Offset of the first frame.
    frames_start: u64,
}

impl Reader {
    /// Opens the file at `path`, which must be of this kind.
    pub fn open(path: &Path, kind: Kind) -> Result<Self> {
        let mut source = Source::open(path, kind)?;
        let messages = source.messages()?;
        let mut rest = &messages[..];
        let index: Index = rmp_serde::from_read(&mut rest)
            .map_err(|error| source.damaged(format!("an index that cannot be read ({error})")))?;
        let frames_start = (HEADER_LENGTH + messages.len()) as u64;
        let end = index.arrays.iter().fold(frames_start, |end, entry| end.saturating_add(entry.length));
        if source.length != end {
            let found = format!("{} bytes", source.length);
            return Err(source.error(found, format!("{end} bytes, as its index says")));
        }
        Ok(Self { meta: rest.to_vec(), source, index, frames_start })
    }

    /// The manifest: the inputs of the content.
    pub fn manifest(&self) -> &Manifest {
        &self.index.manifest
    }

    /// The metadata that [`Writer::new`](super::Writer::new) was given.
    pub fn meta<T: DeserializeOwned>(&self) -> Result<T> {
        let mut rest = &self.meta[..];
        let meta = rmp_serde::from_read(&mut rest)
            .map_err(|error| self.damaged(format!("metadata that cannot be read ({error})")))?;
        if rest.is_empty() { Ok(meta) } else { Err(self.damaged("something after the metadata")) }
    }

    /// The array called `name`.
    pub fn array<T: Number>(&mut self, name: &str) -> Result<Vec<T>> {
        let mut start = self.frames_start;
        for entry in self.index.arrays.clone() {
            if entry.name == name {
                return self.array_at(&entry, start);
            }
            start += entry.length;
        }
        Err(self.damaged(format!("no array {name:?}")))
    }

    fn array_at<T: Number>(&mut self, entry: &ArrayEntry, start: u64) -> Result<Vec<T>> {
        let ArrayEntry { name, number, .. } = entry;
        if number != T::NAME {
            return Err(self.damaged(format!("array {name:?} of {number}, not of {}", T::NAME)));
        }
        let frame = self.source.bytes(start, entry.length)?;
        if *blake3::hash(&frame).as_bytes() != entry.checksum {
            return Err(self.damaged(format!("a wrong checksum of array {name:?}")));
        }
        frame::decompress(&frame, entry.count)
            .map_err(|error| self.damaged(format!("array {name:?} that cannot be unpacked ({error})")))
    }

    /// The error for invalid content; `found` describes it.
    pub fn damaged(&self, found: impl Into<String>) -> Error {
        self.source.damaged(found)
    }
}

/// A file with its expected kind.
#[derive(Debug)]
struct Source {
    path: PathBuf,
    kind: Kind,
    file: File,
    length: u64,
}

impl Source {
    fn open(path: &Path, kind: Kind) -> Result<Self> {
        let (file, length) = open_regular(path).map_err(|error| {
            Error::new(
                path,
                format!("could not be opened ({error})"),
                format!("a readable {} file", kind.noun()),
                "look at its permissions, or remove it",
            )
        })?;
        Ok(Self { path: path.into(), kind, file, length })
    }

    /// The messages after the header, if both are valid.
    fn messages(&mut self) -> Result<Vec<u8>> {
        if self.length < HEADER_LENGTH as u64 {
            return Err(self.damaged(format!("only {} bytes", self.length)));
        }
        let header = self.bytes(0, HEADER_LENGTH as u64)?;
        self.check_origin(&header)?;
        let length = u64::from_le_bytes(header[16..24].try_into().expect("eight bytes"));
        if length > MESSAGES_LIMIT.min(self.length - HEADER_LENGTH as u64) {
            return Err(self.damaged(format!("{} bytes, {length} of them messages", self.length)));
        }
        let messages = self.bytes(HEADER_LENGTH as u64, length)?;
        if checksum(&header[..24], &messages)[..] != header[24..] {
            return Err(self.damaged("a wrong checksum of header and messages"));
        }
        self.check_kind(&header[12..16])?;
        Ok(messages)
    }

    /// Detects foreign files and other versions first, whose further bytes may have any form.
    fn check_origin(&self, header: &[u8]) -> Result<()> {
        if header[..8] != MAGIC {
            let expected = format!("an Equilux {} file", self.kind.noun());
            return Err(self.error("not an Equilux file", expected));
        }
        let version = u32::from_le_bytes(header[8..12].try_into().expect("four bytes"));
        if version != FORMAT_VERSION {
            let expected = format!("version {FORMAT_VERSION}, the one this build reads");
            return Err(self.error(format!("format version {version}"), expected));
        }
        Ok(())
    }

    fn check_kind(&self, code: &[u8]) -> Result<()> {
        if code == self.kind.code() {
            return Ok(());
        }
        let expected = self.kind.code();
        Err(self.error(
            format!("a file of kind {}", code.escape_ascii()),
            format!("kind {}, a {} file", expected.escape_ascii(), self.kind.noun()),
        ))
    }

    /// Reads bytes that lie within the file, so that no more memory is allocated than the file's size.
    fn bytes(&mut self, start: u64, length: u64) -> Result<Vec<u8>> {
        let mut bytes = vec![0; length as usize];
        let read = self.file.seek(SeekFrom::Start(start)).and_then(|_| self.file.read_exact(&mut bytes));
        read.map_err(|error| self.damaged(format!("bytes that cannot be read ({error})")))?;
        Ok(bytes)
    }

    fn damaged(&self, found: impl Into<String>) -> Error {
        self.error(found, format!("an undamaged {} file", self.kind.noun()))
    }

    /// Baking again replaces any invalid cached file.
    fn error(&self, found: impl Into<String>, expected: impl Into<String>) -> Error {
        Error::new(&self.path, found, expected, "bake it again")
    }
}

/// Opens a file and returns its length. Only regular files are opened, because opening a pipe could block.
fn open_regular(path: &Path) -> io::Result<(File, u64)> {
    if !path.metadata()?.is_file() {
        return Err(io::Error::other("not a regular file"));
    }
    let file = File::open(path)?;
    let length = file.metadata()?.len();
    Ok((file, length))
}
