//! Results are byte-identical for any number of threads and any order of nodes, so caches can be shared, and results compared
//! after an exporter wrote a file in another order.

use equilux_tests::model::{Model, Node};
use equilux_tests::rooms::{furnished, square};
use equilux_tests::workshop::Workshop;
use std::collections::BTreeMap;
use std::path::PathBuf;

#[test]
fn outputs_are_the_same_bytes_in_any_order_of_nodes() {
    // Two things of one name and one part, and two of one part with other names.
    let copies = [("plate", 1.0), ("plate", 2.0), ("a plate", 3.0)].map(|(name, x)| Node {
        at: glam::dvec3(x, 1.5, 0.5),
        ..Node { name: name.into(), ..square().remove(0) }
    });
    let mut nodes: Vec<Node> = furnished().into_iter().chain(copies).collect();
    for tolerance in ["0.01", "0"] {
        let results = |nodes: &[Node]| {
            let workshop = Workshop::new();
            Model::of(nodes).write(&workshop.path("scene.glb"));
            let files = files_made_with(tolerance, &["--lightmaps", "--texel-size", "0.25"], &workshop);
            let of_results = |path: &PathBuf| !path.starts_with(workshop.path("made/cache"));
            let relative = |path: PathBuf| path.strip_prefix(workshop.path("")).expect("below").to_owned();
            files
                .into_iter()
                .filter(|(path, _)| of_results(path))
                .map(|(path, bytes)| (relative(path), bytes))
                .collect()
        };
        let one: BTreeMap<PathBuf, Vec<u8>> = results(&nodes);
        assert!(one.keys().any(|path| path.ends_with("lightmap.exr")), "{:?}", one.keys());
        for turn in [1, 3] {
            nodes.rotate_left(turn);
            nodes.swap(0, 2);
            let other = results(&nodes);
            let differing: Vec<_> =
                one.iter().filter(|(path, bytes)| other.get(*path) != Some(bytes)).map(|(p, _)| p).collect();
            assert!(
                differing.is_empty(),
                "tolerance {tolerance}: other bytes in another order of nodes: {differing:?}"
            );
        }
    }
}

#[test]
fn outputs_and_cache_are_the_same_bytes_for_any_number_of_threads() {
    for (tolerance, threads) in [("0.01", "2"), ("0", "4")] {
        the_same_bytes(tolerance, threads);
    }
}

fn the_same_bytes(tolerance: &str, threads: &str) {
    let workshop = Workshop::with(&furnished());
    let made_with = |threads: &str| {
        files_made_with(tolerance, &["--bisect", "3", "--rounds", "4", "--threads", threads], &workshop)
    };
    let one = made_with("1");
    let made = |ending: &str| one.keys().filter(|path| path.to_string_lossy().ends_with(ending)).count();
    for ending in [".eqx", "round-001.png", "final.png", "wireframe.png", "result.glb", "table.csv"] {
        assert!(made(ending) > 0, "nothing that ends in {ending} to compare among {:?}", one.keys());
    }
    let many = made_with(threads);
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
fn files_made_with(tolerance: &str, options: &[&str], workshop: &Workshop) -> BTreeMap<PathBuf, Vec<u8>> {
    let made = "made";
    std::fs::create_dir(workshop.path(made)).expect("a new folder");
    let all = [
        &["scene.glb", "--pictures", "rounds", "--element-size", "0.5", "--tolerance", tolerance][..],
        &["--cache", "made/cache", "--out", "made/out", "--elements", "made/table.csv"],
        options,
    ];
    let run = workshop.run("assemble", &all.concat());
    assert_eq!(run.code, Some(0), "{}", run.stderr);
    let files = workshop.files(made);
    std::fs::remove_dir_all(workshop.path(made)).expect("a folder to remove");
    files
}
