//! A sweep that was killed continues where it ended, and one that is interrupted still reports.

use super::{FOLDER, kept, swept, workshop};
use equilux_tests::program::program;
use equilux_tests::workshop::Workshop;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

/// A running sweep with at least two complete runs.
fn started(workshop: &Workshop) -> Child {
    let running = Command::new(program("assemble"))
        .args(["sweep", "scene.glb", "--budget", "100"])
        .current_dir(workshop.path(""))
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .expect("the program runs");
    let start = Instant::now();
    while kept(workshop) < 2 {
        assert!(start.elapsed() < Duration::from_secs(60), "no two runs in a minute");
        std::thread::sleep(Duration::from_millis(10));
    }
    running
}

#[test]
fn a_killed_sweep_goes_on_where_it_was() {
    let workshop = workshop();
    let mut running = started(&workshop);
    running.kill().expect("a process to kill");
    running.wait().expect("it has ended");
    // The run in progress is not killed and ends by itself; the next sweep removes its folder.
    std::thread::sleep(Duration::from_secs(2));
    let before = kept(&workshop);
    let summary = swept(&workshop, "0.001");
    assert_eq!(summary["reused"], before, "runs that were there");
    let litter = workshop.files(FOLDER).into_keys().find(|path| path.to_string_lossy().contains("running-"));
    assert_eq!(litter, None, "left over");
}

#[test]
fn an_interrupted_sweep_reports_what_is_there() {
    let workshop = workshop();
    let mut running = started(&workshop);
    let sent = Command::new("kill").args(["-INT", &running.id().to_string()]).status().expect("kill runs");
    assert!(sent.success(), "the sweep ended by itself");
    assert_eq!(running.wait().expect("it ends").code(), Some(0));
    assert!(workshop.path(FOLDER).join("report.html").exists(), "no report");
}
