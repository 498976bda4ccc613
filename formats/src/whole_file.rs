//! Files that are there whole or not at all, even where a program is killed while it writes them.
//!
//! In goes a path and a closure that writes; out comes the file under its name, or the old one untouched. Until its last
//! byte a file has a temporary name and is locked, so a temporary file that nobody has locked was left by a process that
//! is gone, and may be removed.

use std::fs::File;
use std::io::{self, BufWriter, Write};
use std::path::Path;
use tempfile::NamedTempFile;

const PREFIX: &str = ".equilux-";
const SUFFIX: &str = ".tmp";

/// Puts what `fill` writes at `path` in one step. Nothing waits for the disk: only a power cut can leave less. Fails as
/// the file system does, and then leaves nothing behind.
pub fn write_whole(path: &Path, fill: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> io::Result<()> {
    let mut file = temporary_in(folder_of(path))?;
    let mut buffered = BufWriter::new(&mut file);
    fill(&mut buffered)?;
    buffered.flush()?;
    drop(buffered);
    // By std's rename, which on Windows, too, replaces a file that another process has open. Locked until it is done.
    let (_locked, temporary) = file.into_parts();
    let temporary = temporary.keep().map_err(|error| error.error)?;
    std::fs::rename(&temporary, path).inspect_err(|_| {
        let _ = std::fs::remove_file(&temporary);
    })
}

/// Fails if no file could be made beside `path`. Leaves nothing behind.
pub fn check_writable_beside(path: &Path) -> io::Result<()> {
    tempfile::tempfile_in(folder_of(path)).map(drop)
}

/// Removes the temporary files beside `path` that killed processes left, as opening a store does in its folder.
pub fn remove_left_over_beside(path: &Path) {
    remove_left_over(folder_of(path));
}

/// Removes the temporary files in `folder` that killed processes left; what is still being written stays. Where the file
/// system has no locks the two cannot be told apart, and all stay.
pub(crate) fn remove_left_over(folder: &Path) {
    for entry in folder.read_dir().into_iter().flatten().flatten() {
        let name = entry.file_name();
        let temporary = name.to_str().is_some_and(|name| name.starts_with(PREFIX) && name.ends_with(SUFFIX));
        // Windows locks no file that is open for appending only.
        if temporary && let Ok(file) = File::options().read(true).append(true).open(entry.path()) {
            // Litter that cannot be removed harms nobody.
            let _ = file.try_lock().map(|()| std::fs::remove_file(entry.path()));
        }
    }
}

/// A locked temporary file that others may read once it has its name, as the umask allows. Dropped before that, it is gone.
fn temporary_in(folder: &Path) -> io::Result<NamedTempFile> {
    let mut builder = tempfile::Builder::new();
    builder.prefix(PREFIX).suffix(SUFFIX);
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
    loop {
        let file = builder.tempfile_in(folder)?;
        // Without locks nobody takes it for left over.
        let _ = file.as_file().lock();
        // It was not locked from its first moment: somebody may have removed it before it was.
        if file.path().exists() {
            return Ok(file);
        }
    }
}

fn folder_of(path: &Path) -> &Path {
    path.parent().filter(|folder| *folder != Path::new("")).unwrap_or(Path::new("."))
}
