//! Files for build tools to watch: created empty, or given the present time, when a run succeeds.

use equilux_formats::{Error, Result, check_writable_beside};
use std::fs::File;
use std::io;
use std::path::Path;
use std::time::SystemTime;

/// Fail where a stamp or a dependency file could not be written, before hours are spent. Leaves nothing behind.
pub fn check(path: &Path) -> Result<()> {
    check_writable_beside(path).map_err(|error| unusable(path, &error))
}

/// Make the file at `path` as new as now, empty if it was not there; content that it has stays.
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
