//! Locks: of the processes that share a cache, one at a time computes the value of a key.
//!
//! The locks are those of the operating system, so they end with the process. They are on a fixed set of empty files
//! that are never removed: removing a file that a process waits for would let two processes proceed. Keys share the
//! files by their first byte, so a process must hold one turn at a time to prevent deadlocks.

use super::Store;
use crate::fingerprint::Key;
use std::fs::{File, TryLockError};
use std::io;

/// The exclusive right to compute a value. It ends when dropped.
#[derive(Debug)]
#[must_use]
pub struct Turn {
    /// The locked file; none on file systems without locks.
    _file: Option<File>,
}

impl Store {
    /// The turn to compute the value of this key, unless another process has it. On file systems without locks, every
    /// process always gets the turn; values may then be computed twice, which costs only time.
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
        // Another user's file can be locked too if it is readable. Windows cannot lock a file that is open for appending only.
        File::options().create(true).read(true).append(true).open(&path).or_else(|_| File::open(&path))
    }
}
