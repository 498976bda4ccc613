//! Making room in the cache: whatever is not needed goes, or what was not used for longest.
//!
//! Only files that a store made are touched, known by their names. A process that reads a file while it goes is not
//! disturbed; one that comes later makes it again.

use super::Store;
use crate::container::{Kind, Reader};
use crate::error::{Error, Result};
use crate::fingerprint::{Digest, Key};
use serde::Serialize;
use std::collections::HashSet;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};
use std::time::SystemTime;

/// What went and what stayed.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize)]
pub struct Evicted {
    /// Removed.
    pub dropped: Tally,
    /// Still there.
    pub kept: Tally,
}

/// How many files, and how large.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize)]
pub struct Tally {
    /// Number of files.
    pub files: usize,
    /// Their sizes added up.
    pub bytes: u64,
}

/// A file that a store made.
struct Cached {
    path: PathBuf,
    kind: Kind,
    /// The key or the name in its file name.
    digest: Digest,
    bytes: u64,
    used: SystemTime,
}

impl Store {
    /// Drops every file that is not under one of these keys. Of what was last made from what, only that is kept which
    /// led to one of the keys.
    pub fn keep_only(&self, keys: &HashSet<Key>) -> Result<Evicted> {
        let keys: HashSet<Digest> = keys.iter().map(|&key| key.into()).collect();
        self.evict(|files| {
            let needed = |file: &Cached| file.key().is_some_and(|key| keys.contains(&key));
            files.into_iter().partition(needed)
        })
    }

    /// Drops what was not used for longest until all files together have at most this many bytes. What was read or
    /// written through this store since it was opened stays, even if it is larger.
    pub fn limit(&self, bytes: u64) -> Result<Evicted> {
        self.evict(|mut files| {
            // By path where times are equal, so that the same files go wherever folders are listed in another order.
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

    /// Removes the second half of what `divide` makes of all files.
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
        // What cannot be looked at was just removed by another process.
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

    /// The key of what it is about.
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
