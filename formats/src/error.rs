//! The one error type: a problem that a person can act on, or an early end that was requested.

use std::path::{Path, PathBuf};

/// A result whose error a person can act on.
pub type Result<T> = std::result::Result<T, Error>;

/// Why there is no result. Never a fault of the program: those panic.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum Error {
    /// Something is wrong with an input or with the environment.
    #[error(transparent)]
    Problem(Problem),
    /// The run was stopped before the result was complete.
    #[error("stopped before the end; run the same command again: what was finished is in the cache")]
    Stopped,
}

/// Something wrong with a file or folder: what was found, what was expected, and what to do about it.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("{}: {found}; expected {expected}; {remedy}", file.display())]
pub struct Problem {
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
    /// A problem with `file`, in the order in which it is read aloud.
    pub fn new(
        file: impl AsRef<Path>,
        found: impl Into<String>,
        expected: impl Into<String>,
        remedy: impl Into<String>,
    ) -> Self {
        Self::Problem(Problem {
            file: file.as_ref().to_path_buf(),
            expected: expected.into(),
            found: found.into(),
            remedy: remedy.into(),
        })
    }
}

/// The value of `result`, or none if the run was stopped before it was complete.
pub fn unless_stopped<T>(result: Result<T>) -> Result<Option<T>> {
    match result {
        Ok(value) => Ok(Some(value)),
        Err(Error::Stopped) => Ok(None),
        Err(error) => Err(error),
    }
}
