//! Support for build tools: a stamp, a dependency file, and one line of output.

use super::{done, told};
use equilux_tests::model::{Model, Node};
use equilux_tests::rooms::{furnished, square};
use equilux_tests::workshop::Workshop;

fn text(workshop: &Workshop, name: &str) -> String {
    std::fs::read_to_string(workshop.path(name)).unwrap_or_else(|error| panic!("{name}: {error}"))
}

/// A scene of part files, one with a name that needs escaping.
fn level() -> Workshop {
    let workshop = Workshop::new();
    std::fs::create_dir(workshop.path("parts")).expect("a folder");
    Model::of(&square()).write(&workshop.path("parts/dim lamp#1.glb"));
    Model::of(&furnished()).write(&workshop.path("parts/room.glb"));
    let nodes = [Node::of_file("room", "parts/room.glb"), Node::of_file("lamp", "parts/dim lamp#1.glb")];
    Model::of(&nodes).write(&workshop.path("level.glb"));
    workshop
}

const SOURCES: &str = r"level.glb parts/dim\ lamp\#1.glb parts/room.glb";

#[test]
fn baking_names_every_file_that_was_read_and_touches_the_stamp() {
    let workshop = level();
    let options = ["level.glb", "--element-size", "1", "--stamp", "baked.stamp", "--depfile", "baked.d"];
    done(&workshop, "bake", &options);
    assert_eq!(text(&workshop, "baked.d"), format!("baked.stamp: {SOURCES}\n"));
    assert_eq!(text(&workshop, "baked.stamp"), "");

    let time = || workshop.path("baked.stamp").metadata().and_then(|stamp| stamp.modified()).expect("a time");
    let before = time();
    done(&workshop, "bake", &options);
    assert!(time() > before, "the stamp is as old as before");
}

#[test]
fn assembling_names_every_file_that_was_read() {
    let workshop = level();
    let options = ["level.glb", "--element-size", "1", "--rounds", "1", "--depfile", "level.d"];
    done(&workshop, "assemble", &options);
    assert_eq!(text(&workshop, "level.d"), format!("out/level/result.glb: {SOURCES}\n"));
}

#[test]
fn a_file_that_fails_keeps_no_other_from_being_baked_but_the_stamp_from_being_touched() {
    let workshop = level();
    std::fs::write(workshop.path("broken.glb"), "moth").expect("a written file");
    let options = ["broken.glb", "level.glb", "--stamp", "x.stamp", "--depfile", "x.d"];
    let ended = workshop.run("bake", &[&options[..], &["--element-size", "1"]].concat());
    assert_eq!(ended.code, Some(1), "{}", ended.stderr);
    assert!(ended.stderr.contains("error: broken.glb: "), "{}", ended.stderr);
    assert!(ended.stdout.contains("2 parts in 2 files: 2 baked, 0 reused"), "{}", ended.stdout);
    assert!(!workshop.path("x.stamp").exists() && !workshop.path("x.d").exists(), "told that all is done");
}

#[test]
fn a_stamp_that_cannot_be_written_is_refused_before_anything_is_baked() {
    let workshop = level();
    let ended = workshop.run("bake", &["level.glb", "--stamp", "nowhere/x.stamp"]);
    assert_eq!(ended.code, Some(1), "{}", ended.stderr);
    assert!(ended.stderr.starts_with("error: nowhere/x.stamp: "), "{}", ended.stderr);
    assert!(!workshop.path(".equilux").exists(), "something was baked");
}

#[test]
fn the_last_line_counts_in_words_that_fit() {
    let workshop = Workshop::with(&square());
    let last = |arguments: &[&str]| {
        let ended = done(&workshop, "bake", arguments);
        ended.stdout.lines().last().expect("a line").to_string()
    };
    let one = last(&["scene.glb", "--element-size", "1"]);
    assert!(one.starts_with("1 part in 1 file: 1 baked, 0 reused; "), "{one}");
    let two = last(&["scene.glb", "scene.glb", "--element-size", "1"]);
    assert!(two.starts_with("2 parts in 2 files: 0 baked, 2 reused; "), "{two}");
    let batch = told(&workshop, "bake", &["scene.glb", "--element-size", "1"]);
    assert!(batch.is_object(), "{batch}");
}
