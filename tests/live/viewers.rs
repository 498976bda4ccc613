//! Access control and responses of the live page's server, without a browser.

use super::page::Page;
use equilux_tests::model::Model;
use equilux_tests::rooms::{echoing, furnished};
use equilux_tests::workshop::Workshop;
use serde_json::Value;

/// Jacobi with a ten-thousandth absorbed goes on for minutes.
pub const ENDLESS: [&str; 6] = ["--element-size", "0.125", "--exchange", "jacobi", "--error", "0"];

/// A page whose exchange has begun and will not end by itself.
pub fn endless(workshop: &Workshop, more: &[&str]) -> Page {
    let page = Page::of(workshop, &[&ENDLESS, more].concat());
    page.wait(|_, news| news["now"]["round"].as_u64() >= Some(3));
    page
}

#[test]
fn only_the_page_itself_is_answered() {
    let workshop = Workshop::with(&echoing(1e-4));
    let page = endless(&workshop, &[]);
    let (own, path) = (format!("Host: {}", page.host()), page.path(""));
    let port = page.host().rsplit(':').next().expect("a port");
    let local = format!("Host: localhost:{port}");
    let origin = format!("Origin: http://{}", page.host());
    let other = if path.ends_with("0/") { '1' } else { '0' };
    let wrong = format!("{}{other}/", &path[..path.len() - 2]);
    let stop = page.path("stop");
    let foreign = "Origin: http://other.example";
    let cases: &[(&str, &str, &[&str], u16)] = &[
        ("GET", &path, &[&own], 200),
        ("GET", &path, &[&local], 200),
        ("GET", &path, &[&own, &origin], 200),
        ("GET", "/", &[&own], 403),
        ("GET", &wrong, &[&own], 403),
        ("GET", &format!("{wrong}events"), &[&own], 403),
        ("GET", &path, &["Host: other.example"], 403),
        ("GET", &path, &[&format!("Host: other.example:{port}")], 403),
        ("GET", &path, &["Host: 127.0.0.1"], 403),
        ("GET", &path, &[&own, foreign], 403),
        ("GET", &path, &[&own, "Origin: null"], 403),
        ("GET", &path, &[&own, "Origin: http://localhost:1"], 403),
        ("GET", &page.path("field/radiosity?after=0"), &[&own, foreign], 403),
        ("GET", &page.path("nothing"), &[&own], 403),
        ("GET", &page.path("field/nothing?after=0"), &[&own], 400),
        ("GET", &stop, &[&own, &origin], 405),
        ("POST", &stop, &[&own], 403),
        ("POST", &stop, &[&own, foreign], 403),
        ("POST", &stop, &["Host: other.example", "Origin: http://other.example"], 403),
        ("POST", &stop, &[&own, &origin, foreign], 403),
        ("POST", &wrong, &[&own, &origin], 403),
        // Nothing is over yet.
        ("POST", &page.path("close"), &[&own, &origin], 409),
    ];
    for (method, path, headers, expected) in cases {
        let answer = page.ask(method, path, headers);
        assert_eq!(answer.status, *expected, "{method} {path} {headers:?}: {}", answer.head);
        let head = answer.head.to_lowercase();
        assert!(!head.contains("access-control"), "other origins are told something: {head}");
        assert!(head.contains("content-security-policy: default-src 'none'"), "no policy in {head}");
    }
    // None of these has stopped it.
    page.wait(|status, news| status["phase"] == "exchange" && news["now"]["round"].as_u64() >= Some(4));
}

#[test]
fn stop_ends_the_exchange_and_everything_is_written_though_a_viewer_never_reads() {
    let workshop = Workshop::with(&echoing(1e-4));
    let mut page =
        endless(&workshop, &["--json", "--lightmaps", "--texel-size", "0.5", "--pictures", "rounds"]);
    let host = format!("Host: {}", page.host());
    let path = page.path("field/radiosity?after=0");
    let _asleep: Vec<_> = ["events", "model"].map(|name| page.open("GET", &page.path(name), &[&host])).into();
    let _fields: Vec<_> = (0..20).map(|_| page.open("GET", &path, &[&host])).collect();
    assert_eq!(page.post("stop").status, 204);
    let status = page.wait(|status, _| status["phase"] == "done");
    let report: Value = serde_json::from_str(&page.says()).expect("a report");
    assert_eq!(report["converged"], false);
    assert_eq!(status["converged"], false);
    assert!(report["rounds"].as_array().expect("a list").len() >= 3);
    let names: Vec<String> = workshop
        .files("out/scene")
        .keys()
        .map(|path| path.file_name().expect("a name").to_string_lossy().into_owned())
        .collect();
    for name in ["round-001.png", "final.png", "result.glb", "lightmap.exr"] {
        assert!(names.iter().any(|n| n == name), "no {name} among {names:?}");
    }
    // A stop that comes late changes nothing, and the page is still there.
    assert_eq!(page.post("stop").status, 409);
    assert_eq!(page.fetch("").status, 200);
    assert_eq!(page.post("close").status, 204);
    assert_eq!(page.code(), Some(0));
}

#[test]
fn ctrl_c_ends_the_exchange_as_stop_does_and_the_program_with_it() {
    let workshop = Workshop::with(&echoing(1e-4));
    let mut page = endless(&workshop, &["--json"]);
    page.interrupt();
    let report: Value = serde_json::from_str(&page.says()).expect("a report");
    assert_eq!(report["converged"], false);
    assert!(workshop.path("out/scene/result.glb").exists());
    assert_eq!(page.code(), Some(0));
}

#[test]
fn fields_hold_what_the_table_of_elements_says() {
    let workshop = Workshop::with(&furnished());
    let page = Page::of(&workshop, &["--element-size", "0.5", "--elements", "table.csv"]);
    let status = page.wait(|status, _| status["phase"] == "done");
    let table = std::fs::read_to_string(workshop.path("table.csv")).expect("the table");
    let rows: Vec<Vec<f64>> = table
        .lines()
        .skip(1)
        .map(|line| line.split(',').take(19).map(|n| n.parse().expect("a number")).collect())
        .collect();
    assert_eq!(status["elements"], rows.len());
    for (name, first) in [("irradiance", 13), ("radiosity", 16)] {
        let found = numbers(&page, name, 3);
        let expected = rows.iter().flat_map(|row| row[first..first + 3].to_vec());
        for (i, (found, expected)) in found.iter().zip(expected).enumerate() {
            // Rounded to f32 once.
            assert!(
                (f64::from(*found) - expected).abs() <= 6e-8 * expected.abs(),
                "{name} {i}: {found}, {expected}"
            );
        }
    }
    // The room is closed, and nothing was in the cache.
    assert!(numbers(&page, "row-sums", 1).iter().all(|&defect| defect < 1e-4));
    assert!(numbers(&page, "computed", 1).iter().all(|&share| share == 1.0));
    drop(page);

    let again = Page::of(&workshop, &["--element-size", "0.5"]);
    let status = again.wait(|status, _| status["phase"] == "done");
    assert!(numbers(&again, "computed", 1).iter().all(|&share| share == 0.0));
    for instance in status["instances"].as_array().expect("instances") {
        assert_eq!(instance["coupling"], "reused", "{instance}");
    }
}

/// A field; `stride` numbers an element.
fn numbers(page: &Page, name: &str, stride: u32) -> Vec<f32> {
    let answer = page.fetch(&format!("field/{name}?after=0"));
    assert_eq!(answer.status, 200, "{name}");
    let word = |i: usize| <[u8; 4]>::try_from(&answer.body[4 * i..4 * i + 4]).expect("four bytes");
    assert_eq!(u32::from_le_bytes(word(4)), stride);
    let numbers: Vec<f32> = (5..answer.body.len() / 4).map(|i| f32::from_le_bytes(word(i))).collect();
    assert!(!numbers.is_empty());
    numbers
}

#[test]
fn with_watch_the_page_follows_edits_and_stop_ends_one_exchange() {
    let workshop = Workshop::with(&echoing(1e-4));
    let mut page = endless(&workshop, &["--watch"]);
    assert_eq!(page.post("stop").status, 204);
    page.wait(|status, _| status["phase"] == "done" && status["run"] == 1);

    std::fs::write(workshop.path("scene.glb"), "nonsense").expect("a file");
    let status = page.wait(|status, _| status["phase"] == "failed");
    assert!(status["error"].as_str().expect("a reason").contains("scene.glb"), "{status}");
    assert_eq!(status["placed"], 1, "what was seen before stays to be seen");

    Model::of(&furnished()).write(&workshop.path("scene.glb"));
    let status =
        page.wait(|status, _| status["phase"] == "done" && status["instances"][0]["name"] == "crate");
    assert_eq!(status["placed"], status["run"]);
    assert_eq!(page.post("close").status, 204);
    assert_eq!(page.code(), Some(0));
}

#[test]
fn a_port_in_use_is_an_error_that_names_it() {
    let workshop = Workshop::with(&echoing(1e-4));
    let page = endless(&workshop, &[]);
    let port = page.host().rsplit(':').next().expect("a port").to_owned();
    let ended = workshop.run("assemble", &["scene.glb", "--live", &port]);
    assert_eq!(ended.code, Some(1));
    assert!(
        ended.stderr.contains(&format!("127.0.0.1:{port}")) && ended.stderr.contains("--live PORT"),
        "{}",
        ended.stderr
    );
    let ended = workshop.run("assemble", &["--live", "scene.glb"]);
    assert_eq!(ended.code, Some(2));
    assert!(ended.stderr.contains("the scene comes before --live"), "{}", ended.stderr);
}
