//! The cache folder: what was baked, by the key of what it was made from, and what each thing was last made from.
//!
//! Processes may share the folder without locks: files appear whole by renaming, and equal keys mean equal content,
//! so it does not matter who writes last. Any file may be removed at any time.

use crate::container::{Kind, Reader, Writer};
use crate::error::{Error, Result};
use crate::fingerprint::{Content, Digest, Key, Manifest};
use crate::stored::Stored;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};

/// A cache folder that can be written to.
#[derive(Debug, Clone)]
pub struct Store {
    folder: PathBuf,
    /// What was found damaged since the folder was opened; clones share it.
    damages: Arc<Mutex<Vec<Error>>>,
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
    /// Opens the folder, and makes it if it is not there.
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
        Ok(Self { folder: folder.into(), damages: Arc::default() })
    }

    /// Where a `kind` of file with this key lies, or would lie.
    pub fn path(&self, kind: Kind, key: impl Into<Digest>) -> PathBuf {
        self.folder.join(format!("{}-{}.eqx", kind.noun(), key.into()))
    }

    /// Looks for what was made from the manifest with this key.
    pub fn load<T: Stored>(&self, key: &Key) -> Lookup<T> {
        let path = self.path(T::KIND, *key);
        if matches!(path.try_exists(), Ok(false)) {
            return Lookup::Missing;
        }
        match read(&path, key) {
            Ok(found) => Lookup::Found(found),
            Err(error) => {
                self.damages.lock().unwrap_or_else(PoisonError::into_inner).push(error.clone());
                Lookup::Damaged(error)
            }
        }
    }

    /// What was found damaged since the last call, in the order in which it was found, so that a person hears of it.
    pub fn take_damages(&self) -> Vec<Error> {
        std::mem::take(&mut *self.damages.lock().unwrap_or_else(PoisonError::into_inner))
    }

    /// Keeps `value`, which was made from what `manifest` lists, under the manifest's key.
    pub fn save<T: Stored>(&self, manifest: &Manifest, value: &T) -> Result<()> {
        value.write(manifest).write_to(&self.path(T::KIND, manifest.key()))
    }

    /// What the thing called `name` was last made from, if that is known.
    pub fn last_manifest(&self, name: &str) -> Option<Manifest> {
        let reader = Reader::open(&self.manifest_path(name), Kind::Manifest).ok()?;
        Some(reader.manifest().clone())
    }

    /// Notes what the thing called `name` was made from, in place of what was noted before.
    pub fn remember(&self, name: &str, manifest: &Manifest) -> Result<()> {
        Writer::new(Kind::Manifest, manifest, &()).write_to(&self.manifest_path(name))
    }

    fn manifest_path(&self, name: &str) -> PathBuf {
        self.path(Kind::Manifest, Content::new().bytes(name).digest())
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
