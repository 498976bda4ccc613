//! The one error type: which file, what was expected, what was found, and what to do about it.

use std::path::{Path, PathBuf};

/// A result whose error a person can act on.
pub type Result<T> = std::result::Result<T, Error>;

/// Something is wrong with an input or with the environment. Never a bug of ours: those panic.
#[derive(Debug, Clone, thiserror::Error)]
#[error("{}: {found}; expected {expected}; {remedy}", file.display())]
pub struct Error {
    /// The file (or folder) the problem lies in.
    pub file: PathBuf,
    /// What should have been there.
    pub expected: String,
    /// What was there.
    pub found: String,
    /// What to do now, as an imperative.
    pub remedy: String,
}

impl Error {
    /// An error about `file`, in the order in which it is read aloud.
    pub fn new(
        file: impl AsRef<Path>,
        found: impl Into<String>,
        expected: impl Into<String>,
        remedy: impl Into<String>,
    ) -> Self {
        Self {
            file: file.as_ref().to_path_buf(),
            expected: expected.into(),
            found: found.into(),
            remedy: remedy.into(),
        }
    }
}
