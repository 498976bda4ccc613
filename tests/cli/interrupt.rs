//! Ctrl-C during the exchange ends it after the round, and everything is still written.

use equilux_tests::program::program;
use equilux_tests::rooms::echoing;
use equilux_tests::workshop::Workshop;
use serde_json::Value;
use std::process::{Command, Stdio};
use std::time::Duration;

/// Jacobi with a thousandth absorbed needs hundreds of rounds; down to rounding, even more.
const ARGUMENTS: [&str; 10] = [
    "scene.glb",
    "--element-size",
    "0.125",
    "--exchange",
    "jacobi",
    "--error",
    "0",
    "--json",
    "--pictures",
    "rounds",
];

#[test]
fn an_interrupted_exchange_ends_after_the_round_and_writes_everything() {
    let workshop = Workshop::with(&echoing(1e-4));
    // With everything in the cache the second run is in the exchange soon.
    let filled = workshop.run("assemble", &[&ARGUMENTS[..], &["--rounds", "1"]].concat());
    assert_eq!(filled.code, Some(0), "{}", filled.stderr);
    // The start of the exchange is not visible from outside. If no round is complete, the test waits longer.
    for patience in (0..6).map(|doubled| Duration::from_millis(400 << doubled)) {
        let report = interrupted_after(patience, &workshop);
        let rounds = report["rounds"].as_array().expect("a list").len();
        if rounds == 0 {
            continue;
        }
        assert_eq!(report["converged"], false, "after {rounds} rounds and {patience:?}");
        let files = workshop.files("out/scene");
        let names: Vec<_> =
            files.keys().map(|path| path.file_name().expect("a name").to_string_lossy()).collect();
        let pictures = names.iter().filter(|name| name.starts_with("round-")).count();
        let shown = (1..=rounds).filter(|&round| round <= 8 || round.is_power_of_two() || round == rounds);
        assert_eq!(pictures, shown.count(), "pictures of {rounds} rounds");
        for name in ["final.png", "wireframe.png", "result.glb"] {
            assert!(names.iter().any(|n| n == name), "no {name} among {names:?}");
        }
        return;
    }
    panic!("in 12 seconds the exchange did not begin");
}

fn interrupted_after(patience: Duration, workshop: &Workshop) -> Value {
    let running = Command::new(program("assemble"))
        .args(ARGUMENTS)
        .current_dir(workshop.path(""))
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("the program runs");
    std::thread::sleep(patience);
    let sent = Command::new("kill").args(["-INT", &running.id().to_string()]).status().expect("kill runs");
    assert!(sent.success(), "the program ended by itself within {patience:?}");
    let output = running.wait_with_output().expect("the program ends");
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    serde_json::from_slice(&output.stdout).expect("a report")
}
