//! Runs scripts of `tests/viewer` under Node.js, with JSON input and output.

use serde_json::Value;
use std::io::Write;
use std::path::Path;
use std::process::{Command, Stdio};

/// The output of a script; none, with a printed reason, if it cannot be run here.
pub fn script(name: &str, input: &Value) -> Option<Value> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("viewer");
    let missing = if !folder.join("node_modules").exists() {
        Some("`npm ci` was not run in tests/viewer".to_owned())
    } else if Command::new("node").arg("--version").stdout(Stdio::null()).status().is_err() {
        Some("there is no `node`".to_owned())
    } else {
        None
    };
    if let Some(missing) = missing {
        println!("skipped: {missing}");
        return None;
    }
    let mut child = Command::new("node")
        .arg(folder.join(name))
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()
        .expect("node starts");
    let mut stdin = child.stdin.take().expect("a pipe");
    stdin.write_all(input.to_string().as_bytes()).expect("node reads");
    drop(stdin);
    let output = child.wait_with_output().expect("node ends");
    let text = String::from_utf8_lossy(&output.stdout);
    let answer: Value = serde_json::from_str(&text).unwrap_or_else(|_| panic!("{name} said '{text}'"));
    if let Some(reason) = answer["skipped"].as_str() {
        println!("skipped: {reason}");
        return None;
    }
    Some(answer)
}
