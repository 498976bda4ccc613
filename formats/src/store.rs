//! The cache folder: results by the key of their inputs, and the latest manifest of each named result.
//!
//! Processes may share the folder: files are created atomically, equal keys mean equal content, so the order of writes
//! does not matter, and locks prevent two processes from computing the same result at the same time. Any file may be
//! removed at any time.

mod eviction;
mod turn;

pub use eviction::{Evicted, Tally};
pub use turn::Turn;

use crate::container::{Kind, Reader, Writer};
use crate::error::{Error, Problem, Result};
use crate::fingerprint::{Content, Digest, Key, Manifest};
use crate::stored::Stored;
use crate::whole_file::remove_left_over;
use rayon::prelude::*;
use std::any::Any;
use std::collections::{BTreeSet, HashMap, HashSet};
use std::fs::File;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::SystemTime;

/// A cache folder that can be written to.
#[derive(Debug, Clone)]
pub struct Store {
    folder: PathBuf,
    /// Clones share it.
    log: Arc<Mutex<Log>>,
    /// Results of [`Store::read_ahead`]; clones share them.
    ahead: Arc<Mutex<HashMap<PathBuf, Box<dyn Any + Send>>>>,
}

/// Events since the folder was opened.
#[derive(Debug, Default)]
struct Log {
    damages: Vec<Problem>,
    /// Files that were read or written.
    used: HashSet<PathBuf>,
}

/// The result of a cache lookup.
#[derive(Debug)]
pub enum Lookup<T> {
    /// The cached value.
    Found(T),
    /// There is no value.
    Missing,
    /// The file is damaged; saving a new value replaces it.
    Damaged(Error),
}

impl Store {
    /// Opens the folder, and creates it if it does not exist. Removes incomplete files of killed processes.
    pub fn open(folder: impl AsRef<Path>) -> Result<Self> {
        let folder = folder.as_ref();
        std::fs::create_dir_all(folder).and_then(|()| tempfile::tempfile_in(folder)).map_err(|error| {
            Error::new(
                folder,
                format!("cannot be used as cache ({error})"),
                "a folder that can be written to",
                "choose another with --cache DIR",
            )
        })?;
        remove_left_over(folder);
        Ok(Self { folder: folder.into(), log: Arc::default(), ahead: Arc::default() })
    }

    /// The path of a file of this kind and key, whether or not it exists.
    pub fn path(&self, kind: Kind, key: impl Into<Digest>) -> PathBuf {
        self.folder.join(format!("{}-{}.eqx", kind.noun(), key.into()))
    }

    /// Looks up the value under this key, or under the key that it is an alias of.
    pub fn load<T: Stored>(&self, key: &Key) -> Lookup<T> {
        let key = &self.target(key);
        let path = self.path(T::KIND, *key);
        if let Some(found) = self.ahead().remove(&path).and_then(|read| read.downcast().ok()) {
            return Lookup::Found(*found);
        }
        if matches!(path.try_exists(), Ok(false)) {
            return Lookup::Missing;
        }
        match read(&path, key) {
            Ok(found) => {
                self.note_use(path);
                Lookup::Found(found)
            }
            Err(error) => {
                self.note_damage(&error);
                Lookup::Damaged(error)
            }
        }
    }

    /// Whether there is a file for the value under this key.
    pub fn has<T: Stored>(&self, key: &Key) -> bool {
        self.path(T::KIND, self.target(key)).exists()
    }

    /// Reads the values under these keys on all threads, for one later [`Store::load`] each. Missing and damaged files
    /// are left to `load`.
    pub fn read_ahead<T: Stored>(&self, keys: &[Key]) {
        let keys: BTreeSet<Key> = keys.iter().map(|key| self.target(key)).collect();
        keys.into_par_iter().for_each(|key| {
            let path = self.path(T::KIND, key);
            if let Ok(found) = read::<T>(&path, &key) {
                self.note_use(path.clone());
                self.ahead().insert(path, Box::new(found));
            }
        });
    }

    /// The damaged files found since the last call, in the order in which they were found.
    pub fn take_damages(&self) -> Vec<Problem> {
        std::mem::take(&mut self.log().damages)
    }

    /// Saves `value` under the key of `manifest`, which lists its inputs.
    pub fn save<T: Stored>(&self, manifest: &Manifest, value: &T) -> Result<()> {
        let path = self.path(T::KIND, manifest.key());
        value.write(manifest).write_to(&path)?;
        self.note_use(path);
        Ok(())
    }

    /// Saves that the result of the inputs in `manifest` equals the value under another key.
    pub fn save_alias(&self, manifest: &Manifest, target: &Key) -> Result<()> {
        let path = self.path(Kind::Alias, manifest.key());
        Writer::new(Kind::Alias, manifest, &self.target(target)).write_to(&path)?;
        self.note_use(path);
        Ok(())
    }

    /// The key that this key is an alias of, or else the key itself.
    pub fn target(&self, key: &Key) -> Key {
        let path = self.path(Kind::Alias, *key);
        let read = || {
            let reader = Reader::open(&path, Kind::Alias).ok()?;
            reader.meta().ok().filter(|_| reader.manifest().key() == *key)
        };
        let target = if path.exists() { read() } else { None };
        if target.is_some() {
            self.note_use(path);
        }
        target.unwrap_or(*key)
    }

    /// The latest manifest of the result called `name`, if known.
    pub fn last_manifest(&self, name: &str) -> Option<Manifest> {
        let reader = Reader::open(&self.manifest_path(name), Kind::Manifest).ok()?;
        Some(reader.manifest().clone())
    }

    /// Saves the latest manifest of the result called `name`, replacing the previous one.
    pub fn remember(&self, name: &str, manifest: &Manifest) -> Result<()> {
        let path = self.manifest_path(name);
        if self.last_manifest(name).as_ref() != Some(manifest) {
            Writer::new(Kind::Manifest, manifest, &()).write_to(&path)?;
        }
        self.note_use(path);
        Ok(())
    }

    fn manifest_path(&self, name: &str) -> PathBuf {
        self.path(Kind::Manifest, Content::new().bytes(name).digest())
    }

    /// Records a use of the file. Its modification time is when it was last used; eviction orders files by it.
    fn note_use(&self, path: PathBuf) {
        // Another user's cache may be read-only. Its times then stay unchanged, which affects only the order of eviction.
        let _ = File::options().append(true).open(&path).and_then(|f| f.set_modified(SystemTime::now()));
        self.log().used.insert(path);
    }

    /// Records a damaged file, once for each file.
    fn note_damage(&self, error: &Error) {
        let Error::Problem(problem) = error else { return };
        let damages = &mut self.log().damages;
        if damages.iter().all(|known| known.file != problem.file) {
            damages.push(problem.clone());
        }
    }

    fn ahead(&self) -> MutexGuard<'_, HashMap<PathBuf, Box<dyn Any + Send>>> {
        self.ahead.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn log(&self) -> MutexGuard<'_, Log> {
        self.log.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

fn read<T: Stored>(path: &Path, key: &Key) -> Result<T> {
    let mut reader = Reader::open(path, T::KIND)?;
    let found = reader.manifest().key();
    if found != *key {
        return Err(reader.damaged(format!("content of key {found}")));
    }
    T::read(&mut reader)
}
