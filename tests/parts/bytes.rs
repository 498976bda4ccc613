//! Results are byte-identical for any number of threads, so caches can be shared and pictures compared.

use equilux_tests::rooms::furnished;
use equilux_tests::workshop::Workshop;
use std::collections::BTreeMap;
use std::path::PathBuf;

#[test]
fn outputs_and_cache_are_the_same_bytes_for_any_number_of_threads() {
    for (tolerance, threads) in [("0.01", "2"), ("0", "4")] {
        the_same_bytes(tolerance, threads);
    }
}

fn the_same_bytes(tolerance: &str, threads: &str) {
    let workshop = Workshop::with(&furnished());
    let one = files_made_with(tolerance, "1", &workshop);
    let made = |ending: &str| one.keys().filter(|path| path.to_string_lossy().ends_with(ending)).count();
    for ending in [".eqx", "round-001.png", "final.png", "wireframe.png", "result.glb", "table.csv"] {
        assert!(made(ending) > 0, "nothing that ends in {ending} to compare among {:?}", one.keys());
    }
    let many = files_made_with(tolerance, threads, &workshop);
    let names = |files: &BTreeMap<PathBuf, Vec<u8>>| files.keys().cloned().collect::<Vec<_>>();
    assert_eq!(names(&one), names(&many), "files with 1 and {threads} threads, tolerance {tolerance}");
    let differing: Vec<_> =
        one.iter().filter(|(path, bytes)| many[*path] != **bytes).map(|(p, _)| p).collect();
    assert!(
        differing.is_empty(),
        "tolerance {tolerance}: with {threads} threads other bytes than with 1: {differing:?}"
    );
}

/// All files of a run with an empty cache, by relative path.
fn files_made_with(tolerance: &str, threads: &str, workshop: &Workshop) -> BTreeMap<PathBuf, Vec<u8>> {
    let made = "made";
    std::fs::create_dir(workshop.path(made)).expect("a new folder");
    let run = workshop.run(
        "assemble",
        &[
            "scene.glb",
            "--pictures",
            "rounds",
            "--element-size",
            "0.5",
            "--bisect",
            "3",
            "--rounds",
            "4",
            "--threads",
            threads,
            "--tolerance",
            tolerance,
            "--cache",
            "made/cache",
            "--out",
            "made/out",
            "--elements",
            "made/table.csv",
        ],
    );
    assert_eq!(run.code, Some(0), "{}", run.stderr);
    let files = workshop.files(made);
    std::fs::remove_dir_all(workshop.path(made)).expect("a folder to remove");
    files
}
