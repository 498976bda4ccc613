//! Atomic file writes: files exist completely or not at all, even if the process is killed while it writes.
//!
//! [`write_whole`] replaces a file completely or leaves the old one untouched. Until it is complete, a file has a
//! temporary name and is locked. A temporary file without a lock was left by a killed process and may be removed.

use std::fs::File;
use std::io::{self, BufWriter, Write};
use std::path::Path;
use tempfile::NamedTempFile;

const PREFIX: &str = ".equilux-";
const SUFFIX: &str = ".tmp";

/// Writes the output of `fill` to `path` atomically, without flushing to disk: only a power failure can truncate the
/// file. On errors of the file system or of `fill`, leaves nothing behind.
pub fn write_whole(path: &Path, fill: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> io::Result<()> {
    let mut file = temporary_in(folder_of(path))?;
    let mut buffered = BufWriter::new(&mut file);
    fill(&mut buffered)?;
    buffered.flush()?;
    drop(buffered);
    // std's rename also replaces a file that another process has open on Windows. The file is locked until then.
    let (_locked, temporary) = file.into_parts();
    let temporary = temporary.keep().map_err(|error| error.error)?;
    std::fs::rename(&temporary, path).inspect_err(|_| {
        let _ = std::fs::remove_file(&temporary);
    })
}

/// Fails if no file can be created beside `path`. Leaves nothing behind.
pub fn check_writable_beside(path: &Path) -> io::Result<()> {
    tempfile::tempfile_in(folder_of(path)).map(drop)
}

/// Removes the temporary files of killed processes beside `path`, as opening a store does in its folder.
pub fn remove_left_over_beside(path: &Path) {
    remove_left_over(folder_of(path));
}

/// Removes the temporary files of killed processes in `folder`; files still being written stay. On file systems without
/// locks the two cannot be distinguished, and all stay.
pub(crate) fn remove_left_over(folder: &Path) {
    for entry in folder.read_dir().into_iter().flatten().flatten() {
        let name = entry.file_name();
        let temporary = name.to_str().is_some_and(|name| name.starts_with(PREFIX) && name.ends_with(SUFFIX));
        // Windows cannot lock a file that is open for appending only.
        if temporary && let Ok(file) = File::options().read(true).append(true).open(entry.path()) {
            // Files that cannot be removed are harmless.
            let _ = file.try_lock().map(|()| std::fs::remove_file(entry.path()));
        }
    }
}

/// A locked temporary file with the permissions of the umask. It is removed when dropped before it is renamed.
fn temporary_in(folder: &Path) -> io::Result<NamedTempFile> {
    let mut builder = tempfile::Builder::new();
    builder.prefix(PREFIX).suffix(SUFFIX);
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
    loop {
        let file = builder.tempfile_in(folder)?;
        // On file systems without locks, no process removes temporary files.
        let _ = file.as_file().lock();
        // Another process may have removed the file before it was locked.
        if file.path().exists() {
            return Ok(file);
        }
    }
}

fn folder_of(path: &Path) -> &Path {
    path.parent().filter(|folder| *folder != Path::new("")).unwrap_or(Path::new("."))
}
