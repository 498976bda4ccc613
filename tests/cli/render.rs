//! Pictures of `assemble render`.

use equilux_tests::rooms::furnished;
use equilux_tests::workshop::Workshop;
use std::fs;

const SIZE: &str = "120x90";

fn rendered(options: &[&str]) -> (Workshop, equilux_tests::workshop::Ended) {
    let workshop = Workshop::with(&furnished());
    let common = ["render", "scene.glb", "--element-size", "1", "--size", SIZE];
    let ended = workshop.run("assemble", &[&common, options].concat());
    (workshop, ended)
}

#[test]
fn a_picture_has_the_size_asked_for_and_says_how_bright_it_is() {
    for options in
        [&["--shading", "flat"][..], &["--exposure", "-1.5"], &["--from", "1,1.6,-2", "--to", "0,1,0"]]
    {
        let (workshop, ended) = rendered(options);
        assert_eq!(ended.code, Some(0), "{options:?}: {}", ended.stderr);
        let picture = image::open(workshop.path("out/scene/render.png")).expect("a picture");
        assert_eq!((picture.width(), picture.height()), (120, 90), "{options:?}");
        assert!(ended.stdout.contains("radiance times"), "{options:?}: {}", ended.stdout);
    }
}

/// The table has the same light as the picture, so the error is zero: all surfaces are white, and the background is dark.
#[test]
fn against_its_own_light_a_scene_errs_nowhere() {
    let (workshop, first) = rendered(&["--elements", "own.csv"]);
    assert_eq!(first.code, Some(0), "{}", first.stderr);
    let options = ["render", "scene.glb", "--element-size", "1", "--size", SIZE, "--shading", "flat"];
    let ended = workshop.run("assemble", &[&options[..], &["--against", "own.csv"]].concat());
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    let picture = image::open(workshop.path("out/scene/error.png")).expect("a picture").to_rgb8();
    let coloured = picture.pixels().filter(|p| p.0.iter().max().unwrap() - p.0.iter().min().unwrap() > 1);
    assert_eq!(coloured.count(), 0, "pixels that are neither white nor grey");
    assert!(picture.pixels().any(|p| p.0[0] > 200), "nothing is white");
}

#[test]
fn a_camera_that_is_not_there_is_named_before_any_work() {
    let (workshop, ended) = rendered(&["--camera", "door"]);
    assert_eq!(ended.code, Some(1), "{}", ended.stdout);
    assert!(
        ended.stderr.contains("scene.glb") && ended.stderr.contains("no camera `door`"),
        "{}",
        ended.stderr
    );
    assert!(!workshop.path("out").exists(), "files of a refused run");
}

#[test]
fn an_eye_that_looks_at_itself_is_refused() {
    let (workshop, ended) = rendered(&["--from", "1,1,1", "--to", "1,1,1"]);
    assert_eq!(ended.code, Some(1), "{}", ended.stdout);
    assert!(ended.stderr.contains("at itself"), "{}", ended.stderr);
    assert!(!workshop.path("out").exists(), "files of a refused run");
}

#[test]
fn shells_are_told_the_options() {
    for program in ["assemble", "bake"] {
        for shell in ["bash", "zsh", "fish"] {
            let ended = Workshop::new().run(program, &["completions", shell]);
            assert_eq!(ended.code, Some(0), "{program} {shell}: {}", ended.stderr);
            assert!(ended.stdout.contains("element-size"), "{program} {shell}: {}", ended.stdout);
        }
    }
    let workshop = Workshop::new();
    fs::write(workshop.path("x"), "").expect("a file");
    assert_eq!(workshop.run("assemble", &["completions", "cobol"]).code, Some(2));
}
