//! The files that a run writes, and the table of elements.

use equilux_tests::rooms::{echoing, furnished};
use equilux_tests::workshop::Workshop;
use serde_json::Value;

const HEADER: &str =
    "x,y,z,nx,ny,nz,area,rho_r,rho_g,rho_b,E_r,E_g,E_b,H_r,H_g,H_b,B_r,B_g,B_b,part,instance";

fn names(workshop: &Workshop) -> Vec<String> {
    let files = workshop.files("out/scene");
    files.keys().map(|path| path.file_name().expect("a name").to_string_lossy().into_owned()).collect()
}

#[test]
fn a_run_leaves_a_picture_of_each_round_and_the_result() {
    let workshop = Workshop::with(&furnished());
    let arguments = ["scene.glb", "--element-size", "1", "--pictures", "rounds", "--rounds", "3"];
    let ended = workshop.run("assemble", &arguments);
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    let rounds = ["round-001.png", "round-002.png", "round-003.png"];
    let expected = [&["final.png", "result.glb"], &rounds[..], &["rounds.png", "wireframe.png"]].concat();
    assert_eq!(names(&workshop), expected);

    // A shorter run takes the third picture away; the comparison adds one.
    let ended = workshop.run("assemble", &[&arguments[..6], &["2", "--verify"]].concat());
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    let expected =
        [&["classic.png", "final.png", "result.glb"], &rounds[..2], &["rounds.png", "wireframe.png"]]
            .concat();
    assert_eq!(names(&workshop), expected);

    // By default there is the result alone, and nothing stale beside it.
    let ended = workshop.run("assemble", &arguments[..3]);
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    assert_eq!(names(&workshop), ["final.png", "result.glb"]);
    let lines = ended.stdout.lines().filter(|line| !line.starts_with("note: ")).count();
    assert!((3..=6).contains(&lines), "a few lines for a person, not\n{}", ended.stdout);
}

#[test]
fn of_many_rounds_the_first_eight_powers_of_two_and_the_last_have_pictures() {
    let workshop = Workshop::with(&echoing(0.01));
    let arguments = [
        "scene.glb",
        "--element-size",
        "1",
        "--exchange",
        "jacobi",
        "--rounds",
        "21",
        "--pictures",
        "rounds",
    ];
    let ended = workshop.run("assemble", &arguments);
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    let rounds = [1, 2, 3, 4, 5, 6, 7, 8, 16, 21].map(|round| format!("round-{round:03}.png"));
    let expected = [
        &["final.png".into(), "result.glb".into()],
        &rounds[..],
        &["rounds.png".into(), "wireframe.png".into()],
    ]
    .concat();
    assert_eq!(names(&workshop), expected);
    assert!(ended.stdout.contains("round-001.png to round-021.png (10 pictures)"), "{}", ended.stdout);
}

#[test]
fn the_table_has_a_header_and_a_line_an_element() {
    let workshop = Workshop::with(&furnished());
    let ended = workshop.run(
        "assemble",
        &["scene.glb", "--element-size", "1", "--rounds", "2", "--elements", "table.csv", "--json"],
    );
    let report: Value = serde_json::from_str(&ended.stdout).unwrap_or_else(|_| panic!("{}", ended.stderr));
    let table = std::fs::read_to_string(workshop.path("table.csv")).expect("the table");
    let mut lines = table.lines();
    assert_eq!(lines.next(), Some(HEADER));
    assert_eq!(lines.clone().count() as u64, report["elements"].as_u64().expect("a number"), "lines");
    for line in lines {
        let fields: Vec<&str> = line.split(',').collect();
        assert_eq!(fields.len(), 21, "fields in '{line}'");
        assert!(
            fields[..19].iter().all(|f| f.parse::<f64>().is_ok_and(f64::is_finite)),
            "numbers in '{line}'"
        );
        assert!(["walls", "table", "light", "crate"].contains(&fields[19]), "part in '{line}'");
    }
}

#[test]
fn the_text_says_what_took_how_long_and_where_things_are() {
    let ended = Workshop::with(&furnished())
        .run("assemble", &["scene.glb", "--element-size", "1", "--rounds", "2", "--verify", "--verbose"]);
    for words in
        ["T1", "T2", "T3", "row sums", "peak", "energy", "classic matrix: largest relative difference"]
    {
        assert!(ended.stdout.contains(words), "nothing about '{words}' in\n{}", ended.stdout);
    }
}
