//! Programs that are killed, and programs that share a cache: results are correct and no files are left over.

mod killed;
mod shared;

use equilux_tests::program::program;
use equilux_tests::workshop::Workshop;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};

/// Starts one of our programs in the workshop's folder.
fn start(workshop: &Workshop, name: &str, arguments: &[&str]) -> Child {
    Command::new(program(name))
        .args(arguments)
        .current_dir(workshop.path(""))
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("the program starts")
}

/// All files in the folder `name` of the workshop, by their paths within it.
fn contents(workshop: &Workshop, name: &str) -> BTreeMap<PathBuf, Vec<u8>> {
    let folder = workshop.path(name);
    let within = |path: &Path| path.strip_prefix(&folder).expect("a file in the folder").to_path_buf();
    workshop.files(name).into_iter().map(|(path, bytes)| (within(&path), bytes)).collect()
}

/// Fails, naming files, where two folders differ.
fn assert_same(found: &BTreeMap<PathBuf, Vec<u8>>, expected: &BTreeMap<PathBuf, Vec<u8>>, what: &str) {
    let names = |files: &BTreeMap<PathBuf, Vec<u8>>| files.keys().cloned().collect::<Vec<_>>();
    assert_eq!(names(found), names(expected), "{what}: files");
    let differing: Vec<_> = expected.iter().filter(|(path, bytes)| found[*path] != **bytes).collect();
    assert!(
        differing.is_empty(),
        "{what}: other bytes in {:?}",
        differing.iter().map(|d| d.0).collect::<Vec<_>>()
    );
}
