//! The error type: a problem that the user can solve, or a requested stop.

use std::path::{Path, PathBuf};

/// A result with an [`Error`].
pub type Result<T> = std::result::Result<T, Error>;

/// Why there is no result. Internal errors panic instead.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum Error {
    /// Something is wrong with an input or with the environment.
    #[error(transparent)]
    Problem(Problem),
    /// The run was stopped before the result was complete.
    #[error("stopped before the end; run the same command again: what was finished is in the cache")]
    Stopped,
}

/// A problem with a file or folder: what was found, what was expected, and the remedy.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("{}: {found}; expected {expected}; {remedy}", file.display())]
pub struct Problem {
    /// The file or folder.
    pub file: PathBuf,
    /// What was expected.
    pub expected: String,
    /// What was found.
    pub found: String,
    /// The remedy, as an imperative.
    pub remedy: String,
}

impl Error {
    /// A problem with `file`; arguments are in the order of the message.
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
