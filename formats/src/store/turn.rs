//! Taking turns: of the processes that share a cache, one at a time makes what belongs under a key.
//!
//! The locks are the operating system's, so they end with the process, however that ends. They are on a fixed set of
//! empty files that are never removed: removing a file that somebody waits for would let two go on at once. Keys share
//! them by their first byte, so a process must have one turn at a time, lest two wait for each other for ever.

use super::Store;
use crate::fingerprint::Key;
use std::fs::{File, TryLockError};
use std::io;

/// The turn to make something. It ends when this is dropped.
#[derive(Debug)]
#[must_use]
pub struct Turn {
    /// Locked; none where there are no locks.
    _file: Option<File>,
}

impl Store {
    /// The turn to make what belongs under this key, unless another process has it. Where the file system has no locks,
    /// everybody has a turn always: then a thing may be made twice, which costs time and nothing else.
    pub fn try_turn(&self, key: &Key) -> Option<Turn> {
        let Ok(file) = self.lock_file(key) else { return Some(Turn { _file: None }) };
        match file.try_lock() {
            Ok(()) => Some(Turn { _file: Some(file) }),
            Err(TryLockError::WouldBlock) => None,
            Err(TryLockError::Error(_)) => Some(Turn { _file: None }),
        }
    }

    fn lock_file(&self, key: &Key) -> io::Result<File> {
        let folder = self.folder.join("locks");
        std::fs::create_dir_all(&folder)?;
        let path = folder.join(&key.to_string()[..2]);
        // Another user's file can be locked too, as long as it can be read. Windows locks no file that is open for appending only.
        File::options().create(true).read(true).append(true).open(&path).or_else(|_| File::open(&path))
    }
}
