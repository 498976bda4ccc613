//! The cache folder: what was baked, by the key of what it was made from, and what each thing was last made from.
//!
//! Processes may share the folder: files appear whole by renaming, equal keys mean equal content, so it does not matter
//! who writes last, and turns keep two from making the same thing at once. Any file may be removed at any time.

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
    /// What was read ahead of being asked for; clones share it.
    ahead: Arc<Mutex<HashMap<PathBuf, Box<dyn Any + Send>>>>,
}

/// What happened since the folder was opened.
#[derive(Debug, Default)]
struct Log {
    damages: Vec<Problem>,
    /// Files that were read or written.
    used: HashSet<PathBuf>,
}

/// What the cache has under a key.
#[derive(Debug)]
pub enum Lookup<T> {
    /// The thing itself.
    Found(T),
    /// Nothing.
    Missing,
    /// A file that is no use: say so, and make it again; saving replaces it.
    Damaged(Error),
}

impl Store {
    /// Opens the folder, and makes it if it is not there. Removes what killed processes left half-written.
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

    /// Where a `kind` of file with this key lies, or would lie.
    pub fn path(&self, kind: Kind, key: impl Into<Digest>) -> PathBuf {
        self.folder.join(format!("{}-{}.eqx", kind.noun(), key.into()))
    }

    /// Looks for what was made from the manifest with this key, or would be the same.
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

    /// Reads what lies under these keys on all threads, for [`Store::load`] to have it at hand, once. What is missing or
    /// damaged is left to that.
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

    /// What was found damaged since the last call, in the order in which it was found, so that a person hears of it.
    pub fn take_damages(&self) -> Vec<Problem> {
        std::mem::take(&mut self.log().damages)
    }

    /// Keeps `value`, which was made from what `manifest` lists, under the manifest's key.
    pub fn save<T: Stored>(&self, manifest: &Manifest, value: &T) -> Result<()> {
        let path = self.path(T::KIND, manifest.key());
        value.write(manifest).write_to(&path)?;
        self.note_use(path);
        Ok(())
    }

    /// Notes that what would be made from what `manifest` lists is what lies under another key.
    pub fn save_alias(&self, manifest: &Manifest, target: &Key) -> Result<()> {
        let path = self.path(Kind::Alias, manifest.key());
        Writer::new(Kind::Alias, manifest, &self.target(target)).write_to(&path)?;
        self.note_use(path);
        Ok(())
    }

    /// The key under which what belongs under this key really lies: another one if it has an alias, else the same.
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

    /// What the thing called `name` was last made from, if that is known.
    pub fn last_manifest(&self, name: &str) -> Option<Manifest> {
        let reader = Reader::open(&self.manifest_path(name), Kind::Manifest).ok()?;
        Some(reader.manifest().clone())
    }

    /// Notes what the thing called `name` was made from, in place of what was noted before.
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

    /// A file's time is when it was last used: eviction orders files by it.
    fn note_use(&self, path: PathBuf) {
        // Another user's cache may be read-only: its times stay as they are, and only the order of eviction depends on them.
        let _ = File::options().append(true).open(&path).and_then(|f| f.set_modified(SystemTime::now()));
        self.log().used.insert(path);
    }

    /// A file that is looked at twice is told of once.
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
