//! Cache eviction removes files that are not needed, and no others.

use super::{done, told};
use equilux_tests::model::{Model, Node};
use equilux_tests::rooms::{echoing, furnished};
use equilux_tests::workshop::Workshop;
use glam::dvec3;
use std::collections::BTreeSet;
use std::ffi::OsString;

/// By rays a block that an edit left as it was has an alias, which a run from nothing has not.
const EXACT: [&str; 6] = ["--element-size", "1", "--cache", "cache", "--rows", "exact"];
const COARSE: [&str; 4] = ["--element-size", "1", "--cache", "cache"];
const FINE: [&str; 4] = ["--element-size", "0.5", "--cache", "cache"];

fn assembled(workshop: &Workshop, scene: &str, options: &[&str]) -> u64 {
    let report = told(workshop, "assemble", &[&[scene, "--rounds", "2"], options].concat());
    report["form_factors_computed"].as_u64().expect("a number")
}

/// Names of the cached files.
fn cached(workshop: &Workshop) -> BTreeSet<OsString> {
    let files = workshop.files("cache").into_keys();
    files
        .filter(|p| p.extension().is_some_and(|e| e == "eqx"))
        .filter_map(|p| Some(p.file_name()?.into()))
        .collect()
}

/// The files that a run of the scene alone writes into an empty cache.
fn needed(nodes: &[Node], options: &[&str]) -> BTreeSet<OsString> {
    let workshop = Workshop::with(nodes);
    assembled(&workshop, "scene.glb", options);
    cached(&workshop)
}

/// The table stands elsewhere than before, a scene has other options, another is not named at all, and something else is
/// in the folder too.
#[test]
fn exactly_what_a_run_of_the_named_scenes_would_make_stays() {
    let moved = || {
        let mut nodes = furnished();
        nodes[1].at = dvec3(0.25, 0.0, 0.0);
        nodes
    };
    let workshop = Workshop::with(&furnished());
    assembled(&workshop, "scene.glb", &FINE);
    assembled(&workshop, "scene.glb", &EXACT);
    Model::of(&moved()).write(&workshop.path("scene.glb"));
    Model::of(&echoing(0.1)).write(&workshop.path("other.glb"));
    assembled(&workshop, "scene.glb", &EXACT);
    assembled(&workshop, "other.glb", &EXACT);
    std::fs::write(workshop.path("cache/readme.txt"), "mine").expect("a written file");

    let before = cached(&workshop).len();
    let evicted = told(&workshop, "bake", &[&["scene.glb", "--gc"], &EXACT[..]].concat());
    let needed = needed(&moved(), &EXACT);
    assert_eq!(cached(&workshop), needed, "kept and needed");
    assert_eq!(evicted["kept"]["files"], needed.len(), "{evicted}");
    assert_eq!(evicted["dropped"]["files"], before - needed.len(), "{evicted}");
    assert_eq!(assembled(&workshop, "scene.glb", &EXACT), 0, "form factors computed after eviction");
    assert_eq!(cached(&workshop), needed, "nothing was made anew");
    assert!(workshop.path("cache/readme.txt").exists(), "a file that is not ours");
}

#[test]
fn cells_between_planes_are_known_too() {
    let workshop = Workshop::with(&furnished());
    let cells = [&["--bisect", "3"], &COARSE[..]].concat();
    assembled(&workshop, "scene.glb", &COARSE);
    assembled(&workshop, "scene.glb", &cells);
    done(&workshop, "bake", &[&["scene.glb", "--gc"], &cells[..]].concat());
    assert_eq!(cached(&workshop), needed(&furnished(), &cells));
}

#[test]
fn nothing_is_dropped_while_a_scene_cannot_be_read() {
    let workshop = Workshop::with(&furnished());
    assembled(&workshop, "scene.glb", &COARSE);
    let before = cached(&workshop);
    let ended = workshop.run("bake", &[&["scene.glb", "missing.glb", "--gc"], &COARSE[..]].concat());
    assert_eq!(ended.code, Some(1), "{}", ended.stderr);
    assert!(ended.stderr.contains("missing.glb"), "{}", ended.stderr);
    assert_eq!(cached(&workshop), before);
}

#[test]
fn a_limit_drops_what_was_not_used_for_longest_but_nothing_of_this_run() {
    let workshop = Workshop::with(&furnished());
    Model::of(&echoing(0.1)).write(&workshop.path("other.glb"));
    let bake =
        |scene: &str, limit: &[&str]| told(&workshop, "bake", &[&[scene], &COARSE[..], limit].concat());
    bake("other.glb", &[]);
    let other = cached(&workshop);
    bake("scene.glb", &[]);
    let both = cached(&workshop);
    assert_eq!(bake("other.glb", &["--cache-limit", "1GB"])["swept"]["dropped"]["files"], 0);
    assert_eq!(cached(&workshop), both, "under the limit");

    let batch = bake("other.glb", &["--cache-limit", "1kB"]);
    assert_eq!(cached(&workshop), other, "the other scene is older, though it was made later");
    assert_eq!(batch["swept"]["dropped"]["files"], both.len() - other.len(), "{}", batch["swept"]);

    assembled(&workshop, "scene.glb", &[&COARSE[..], &["--cache-limit", "1kB"]].concat());
    assert!(cached(&workshop).is_disjoint(&other), "assembling has a limit too");
    assert_eq!(assembled(&workshop, "scene.glb", &COARSE), 0, "form factors after a run with a limit");
}
