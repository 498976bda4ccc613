//! `assemble sweep` reports error against run time, continues where it was stopped, and compares with classic methods.

mod bad_truth;
mod classic;
mod files;
mod front;
#[cfg(unix)]
mod stopped;

use equilux_tests::rooms::furnished;
use equilux_tests::workshop::Workshop;
use serde_json::Value;

/// The folder of a sweep of scene.glb.
const FOLDER: &str = "out/scene/sweep";

/// A small room with a table and a crate in it.
fn workshop() -> Workshop {
    Workshop::with(&furnished())
}

/// The summary of a sweep that succeeds.
fn swept(workshop: &Workshop, budget: &str) -> Value {
    let ended = workshop.run("assemble", &["sweep", "scene.glb", "--budget", budget, "--json"]);
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    serde_json::from_str(&ended.stdout).unwrap_or_else(|_| panic!("not one object: {}", ended.stdout))
}

/// The number of runs that are kept.
fn kept(workshop: &Workshop) -> usize {
    workshop
        .files(&format!("{FOLDER}/runs"))
        .keys()
        .filter(|path| path.extension().is_some_and(|e| e == "json"))
        .count()
}

/// The number of runs in a summary.
fn reported(summary: &Value) -> usize {
    ["runs", "exchanges"].iter().map(|list| summary[list].as_array().expect("a list").len()).sum()
}
