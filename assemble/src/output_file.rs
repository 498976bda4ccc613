//! Output files that are written whole or not at all. Input: a path and a closure that writes the contents. Output: the
//! complete file under that path, or the previous file unchanged.

use equilux_formats::whole_file::{remove_left_over_beside, write_whole};
use equilux_formats::{Error, Result};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

/// Files that were written, with notes about them.
#[derive(Debug)]
pub struct WrittenFiles {
    /// Paths of the files.
    pub paths: Vec<PathBuf>,
    /// Notes for the report, one sentence each.
    pub notes: Vec<String>,
}

/// Write the contents that `fill` produces to `path` in one step. Fails if the folder is not writable or the disk is full, and
/// then leaves no file behind. Removes temporary files that a killed run left beside `path`.
pub fn write(path: &Path, fill: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> Result<()> {
    remove_left_over_beside(path);
    write_whole(path, fill).map_err(|error| {
        Error::new(
            path,
            format!("could not be written ({error})"),
            "a writable folder with enough room",
            "make room or choose another output folder",
        )
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;

    #[test]
    fn a_failed_write_keeps_the_old_file_and_leaves_nothing_else() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("out.txt");
        write(&path, |out| out.write_all(b"old")).unwrap();
        let failed = write(&path, |out| {
            out.write_all(b"half")?;
            Err(io::Error::other("disk full"))
        });
        assert!(failed.unwrap_err().to_string().contains("disk full"));
        assert_eq!(fs::read(&path).unwrap(), b"old");
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1, "files in the folder");
    }
}
