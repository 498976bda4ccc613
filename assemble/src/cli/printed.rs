//! The text that a command prints on stdout.

use serde::Serialize;

/// The text for stdout: JSON if requested, otherwise plain text.
pub fn printed_text<T: Serialize>(json: bool, what: &T, text: impl Fn(&T) -> String) -> String {
    if json { serde_json::to_string(what).expect("a report is plain data") + "\n" } else { text(what) }
}
