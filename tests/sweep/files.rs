//! The files that a sweep writes; complete runs are not repeated.

use super::{FOLDER, kept, reported, swept, workshop};

#[test]
fn a_sweep_writes_what_machines_and_people_read_and_runs_nothing_twice() {
    let workshop = workshop();
    // Light at points by 4096 rays each takes a second of a run, and three beside other tests.
    let first = swept(&workshop, "12");
    assert_eq!(first["reused"], 0);
    assert!(reported(&first) >= 4, "only {} runs in 12 s", reported(&first));
    assert_eq!(kept(&workshop), reported(&first), "a file a run");

    let text = |name: &str| std::fs::read_to_string(workshop.path(FOLDER).join(name)).expect(name);
    let written: serde_json::Value = serde_json::from_str(&text("sweep.json")).expect("JSON");
    assert_eq!(written, first, "sweep.json and --json");
    let runs = first["runs"].as_array().expect("a list");
    let table = text("sweep.csv");
    let mut lines = table.lines().map(|line| line.split(',').count());
    let columns = lines.next().expect("a header");
    assert!(lines.all(|fields| fields == columns), "ragged lines in\n{table}");
    assert_eq!(table.lines().count(), runs.len() + 1, "lines of sweep.csv");
    for run in runs {
        let [flat, gathered] =
            ["elements", "gathered"].map(|of| run["errors"][of].as_f64().expect("an error"));
        // A room with a lamp on its ceiling: light with an error above the mean is not that of this scene.
        assert!(flat < 1.0 && gathered < 1.0, "{}: {flat} and {gathered}", run["label"]);
        assert!(run["seconds_solve"].as_f64() > Some(0.0), "{run}");
    }
    assert!(runs.iter().any(|run| run["on_gathered_front"] == true), "nothing on the front");

    let page = text("report.html");
    for outside in ["http", "src=", "href=", "url(", "@import", "<script"] {
        assert!(!page.contains(outside), "the page contains {outside}");
    }
    assert!(page.contains("<svg") && page.contains("assemble scene.glb"), "no chart or command in the page");

    // Too little time for a new run.
    let again = swept(&workshop, "0.001");
    assert_eq!(again["reused"], reported(&first), "runs that were there");
    let commands = |summary: &serde_json::Value| -> Vec<serde_json::Value> {
        summary["runs"].as_array().expect("a list").iter().map(|run| run["command"].clone()).collect()
    };
    assert_eq!(commands(&again), commands(&first));
}
