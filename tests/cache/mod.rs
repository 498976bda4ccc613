//! Cache eviction, copied caches, and stamps and dependency files for build tools.

mod build_tools;
mod copied;
mod eviction;

use equilux_tests::workshop::{Ended, Workshop};
use serde_json::Value;

/// Runs a program, and expects no error.
fn done(workshop: &Workshop, program: &str, arguments: &[&str]) -> Ended {
    let ended = workshop.run(program, arguments);
    assert_eq!(ended.code, Some(0), "{program} {arguments:?}: {}", ended.stderr);
    ended
}

/// What a program prints with `--json`.
fn told(workshop: &Workshop, program: &str, arguments: &[&str]) -> Value {
    let ended = done(workshop, program, &[arguments, &["--json"]].concat());
    serde_json::from_str(&ended.stdout).unwrap_or_else(|error| panic!("{error}: {}", ended.stdout))
}
