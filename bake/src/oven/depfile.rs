//! A dependency file as Make, Ninja and CMake read it: one line `target: source source …`.
//!
//! In such a line a space ends a name, `#` begins a comment and `$` a variable. A backslash escapes a space or `#`, and
//! `$$` is a dollar sign. Backslashes before a space are doubled, as compilers do and Ninja's manual requires. Names
//! with line breaks cannot be represented.

use equilux_formats::whole_file::write_whole;
use equilux_formats::{Error, Result};
use std::path::{Path, PathBuf};

/// Writes to `path` that `target` depends on `sources`. Paths are written as given.
pub fn write(path: &Path, target: &Path, sources: &[PathBuf]) -> Result<()> {
    let line = line(target, sources);
    write_whole(path, |out| out.write_all(&line)).map_err(|error| {
        Error::new(
            path,
            format!("could not be written ({error})"),
            "a place in a folder that can be written to",
            "make the folder or choose another with --depfile FILE",
        )
    })
}

fn line(target: &Path, sources: &[PathBuf]) -> Vec<u8> {
    let mut line = escaped(target);
    line.push(b':');
    for source in sources {
        line.push(b' ');
        line.extend(escaped(source));
    }
    line.push(b'\n');
    line
}

fn escaped(path: &Path) -> Vec<u8> {
    let mut escaped = Vec::new();
    let mut backslashes = 0;
    for &byte in path.as_os_str().as_encoded_bytes() {
        match byte {
            b' ' => escaped.resize(escaped.len() + backslashes + 1, b'\\'),
            b'#' => escaped.push(b'\\'),
            b'$' => escaped.push(b'$'),
            _ => {}
        }
        escaped.push(byte);
        backslashes = if byte == b'\\' { backslashes + 1 } else { 0 };
    }
    escaped
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_means_something_to_make_is_escaped() {
        let sources = ["parts/big hall.glb", r"odd\name", r"trailing\ space", "#1.bin", "cash$.bin"];
        let line = line(Path::new("out dir/x.stamp"), &sources.map(PathBuf::from));
        let expected = r"out\ dir/x.stamp: parts/big\ hall.glb odd\name trailing\\\ space \#1.bin cash$$.bin";
        assert_eq!(String::from_utf8(line).unwrap(), format!("{expected}\n"));
    }
}
