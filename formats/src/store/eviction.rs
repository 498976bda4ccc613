//! Cache eviction: removes files that are not needed, or the least recently used ones.
//!
//! Only files with names of a store are removed. A process that is reading a file is not affected; later ones compute
//! its content again.

use super::Store;
use crate::container::{Kind, Reader};
use crate::error::{Error, Result};
use crate::fingerprint::{Digest, Key};
use serde::Serialize;
use std::collections::HashSet;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};
use std::time::SystemTime;

/// The result of an eviction.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize)]
pub struct Evicted {
    /// Removed files.
    pub dropped: Tally,
    /// Remaining files.
    pub kept: Tally,
}

/// Number and size of files.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize)]
pub struct Tally {
    /// Number of files.
    pub files: usize,
    /// Total size, bytes.
    pub bytes: u64,
}

/// A file of a store.
struct Cached {
    path: PathBuf,
    kind: Kind,
    /// The digest in its file name.
    digest: Digest,
    bytes: u64,
    used: SystemTime,
}

impl Store {
    /// Removes every file that does not belong to one of these keys. Latest manifests stay if they have one of these keys.
    pub fn keep_only(&self, keys: &HashSet<Key>) -> Result<Evicted> {
        let keys: HashSet<Digest> = keys.iter().map(|&key| key.into()).collect();
        self.evict(|files| {
            let needed = |file: &Cached| file.key().is_some_and(|key| keys.contains(&key));
            files.into_iter().partition(needed)
        })
    }

    /// Removes the least recently used files until all files together have at most this many bytes. Files that were
    /// read or written through this store since it was opened stay, even if they are larger.
    pub fn limit(&self, bytes: u64) -> Result<Evicted> {
        self.evict(|mut files| {
            // By path if times are equal, so that the result does not depend on the order of directory entries.
            files.sort_by(|a, b| (a.used, &a.path).cmp(&(b.used, &b.path)));
            let mut left: u64 = files.iter().map(|file| file.bytes).sum();
            let log = self.log();
            files.into_iter().partition(|file| {
                let stays = left <= bytes || log.used.contains(&file.path);
                left -= if stays { 0 } else { file.bytes };
                stays
            })
        })
    }

    /// Divides all files with `divide` into kept and dropped ones, and removes the latter.
    fn evict(&self, divide: impl FnOnce(Vec<Cached>) -> (Vec<Cached>, Vec<Cached>)) -> Result<Evicted> {
        let (kept, dropped) = divide(self.files()?);
        dropped.iter().try_for_each(|file| remove(&file.path))?;
        Ok(Evicted { dropped: tally(&dropped), kept: tally(&kept) })
    }

    fn files(&self) -> Result<Vec<Cached>> {
        let entries = self.folder.read_dir().map_err(|error| {
            let found = format!("cannot be listed ({error})");
            Error::new(&self.folder, found, "a folder that can be read", "check its permissions")
        })?;
        // Files without metadata were just removed by another process.
        Ok(entries.flatten().filter_map(|entry| Cached::at(entry.path())).collect())
    }
}

impl Cached {
    fn at(path: PathBuf) -> Option<Self> {
        let (noun, digest) = path.file_name()?.to_str()?.strip_suffix(".eqx")?.split_once('-')?;
        let kind = Kind::ALL.into_iter().find(|kind| kind.noun() == noun)?;
        let digest = Digest::from_hex(digest)?;
        let metadata = path.metadata().ok().filter(std::fs::Metadata::is_file)?;
        let used = metadata.modified().unwrap_or(SystemTime::UNIX_EPOCH);
        Some(Self { kind, digest, bytes: metadata.len(), used, path })
    }

    /// The key that it belongs to.
    fn key(&self) -> Option<Digest> {
        match self.kind {
            Kind::Manifest => Some(Reader::open(&self.path, self.kind).ok()?.manifest().key().into()),
            _ => Some(self.digest),
        }
    }
}

fn remove(path: &Path) -> Result<()> {
    match std::fs::remove_file(path) {
        Err(error) if error.kind() != ErrorKind::NotFound => Err(Error::new(
            path,
            format!("cannot be removed ({error})"),
            "a cache folder that can be written to",
            "check its permissions",
        )),
        _ => Ok(()),
    }
}

fn tally(files: &[Cached]) -> Tally {
    Tally { files: files.len(), bytes: files.iter().map(|file| file.bytes).sum() }
}
