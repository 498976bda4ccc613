//! The text that a command prints on stdout.

use serde::Serialize;

/// What goes to stdout: for machines if they asked, else for people.
pub fn said<T: Serialize>(json: bool, what: &T, text: impl Fn(&T) -> String) -> String {
    if json { serde_json::to_string(what).expect("a report is plain data") + "\n" } else { text(what) }
}
