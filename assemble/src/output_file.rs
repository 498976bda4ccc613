//! Files that are there whole or not at all. In goes a path and a closure that writes; out comes the file under its
//! name, or the old one untouched.

use equilux_formats::{Error, Result, remove_left_over_beside, write_whole};
use std::io::{self, Write};
use std::path::Path;

/// Puts what `fill` writes at `path` in one step. Fails when the folder cannot be written or is full, and then leaves
/// nothing behind. Takes away what a killed run left half-written beside it.
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
