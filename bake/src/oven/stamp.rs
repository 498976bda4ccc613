//! Files for build tools to watch: created empty, or given the present time, when a run succeeds.

use equilux_formats::whole_file::check_writable_beside;
use equilux_formats::{Error, Result};
use std::fs::File;
use std::io;
use std::path::Path;
use std::time::SystemTime;

/// Checks before a long run that a stamp or dependency file can be written to `path`. Leaves nothing behind.
pub fn check(path: &Path) -> Result<()> {
    check_writable_beside(path).map_err(|error| unusable(path, &error))
}

/// Sets the modification time of the file at `path` to now, and creates an empty file if there is none.
pub fn touch(path: &Path) -> Result<()> {
    let file = File::options().create(true).append(true).open(path);
    file.and_then(|file| file.set_modified(SystemTime::now())).map_err(|error| unusable(path, &error))
}

fn unusable(path: &Path, error: &io::Error) -> Error {
    Error::new(
        path,
        format!("cannot be written ({error})"),
        "a place in a folder that can be written to",
        "make the folder or choose another file",
    )
}
