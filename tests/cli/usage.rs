//! Help that shows how, and exit code 2 for what cannot be meant.

use equilux_tests::rooms::square;
use equilux_tests::workshop::Workshop;

#[test]
fn help_shows_examples() {
    for program in ["bake", "assemble"] {
        let help = Workshop::new().run(program, &["--help"]);
        assert_eq!(help.code, Some(0), "{program}: {}", help.stderr);
        let examples = help.stdout.split("Examples:").nth(1).unwrap_or_default();
        let count = examples.lines().filter(|line| line.trim().starts_with(program)).count();
        assert!(count >= 2, "{program}: {count} examples in its help:\n{}", help.stdout);
    }
}

#[test]
fn a_folder_with_one_scene_is_that_scene() {
    let workshop = Workshop::with(&square());
    let options = ["--element-size", "1", "--pictures", "none"];
    let ended = workshop.run("assemble", &[&["."], &options[..]].concat());
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    assert!(ended.stdout.starts_with("scene: 1 elements"), "{}", ended.stdout);
    std::fs::copy(workshop.path("scene.glb"), workshop.path("other.glb")).expect("a second scene");
    let ended = workshop.run("assemble", &[&["."], &options[..]].concat());
    assert_eq!(ended.code, Some(1), "{}", ended.stdout);
    assert!(ended.stderr.contains("name a file"), "{}", ended.stderr);
}

#[test]
fn a_wrong_command_line_is_exit_code_2_and_touches_nothing() {
    let workshop = Workshop::with(&square());
    let before = workshop.files("");
    for program in ["bake", "assemble"] {
        for arguments in [
            &[][..],
            &["scene.glb", "--element-sice", "1"],
            &["scene.glb", "--element-size", "-1"],
            &["scene.glb", "--element-size", "nan"],
            &["scene.glb", "--element-size", "coarse"],
            &["scene.glb", "--bisect", "0"],
            &["scene.glb", "--bisect", "2", "--cut", "x=0.5"],
            &["scene.glb", "--cut", "w=0.5"],
            &["scene.glb", "--cut", "x=inf"],
            &["scene.glb", "--threads", "0"],
            &["scene.glb", "--local-solver", "magic"],
            &["scene.glb", "--tolerance", "-1"],
        ] {
            refused(&workshop, program, arguments);
        }
    }
    refused(&workshop, "assemble", &["scene.glb", "scene.glb"]);
    refused(&workshop, "assemble", &["plan"]);
    refused(&workshop, "assemble", &["plan", "scene.glb", "--tolerance", "2"]);
    refused(&workshop, "assemble", &["sweep"]);
    refused(&workshop, "assemble", &["sweep", "scene.glb", "--budget", "0"]);
    refused(&workshop, "assemble", &["classic", "scene.glb", "--rays", "0"]);
    refused(&workshop, "assemble", &["classic", "scene.glb", "--unshot", "1"]);
    refused(&workshop, "assemble", &["scene.glb", "--exchange", "gossip"]);
    refused(&workshop, "assemble", &["scene.glb", "--error", "-1"]);
    refused(&workshop, "assemble", &["scene.glb", "--rounds", "few"]);
    refused(&workshop, "assemble", &["scene.glb", "--exact-rows", "some"]);
    refused(&workshop, "assemble", &["scene.glb", "--target-error", "0"]);
    refused(&workshop, "assemble", &["scene.glb", "--target-error", "1%", "--tolerance", "0.1"]);
    refused(&workshop, "assemble", &["scene.glb", "--live", "99999"]);
    refused(&workshop, "assemble", &["render", "scene.glb", "--size", "0x10"]);
    refused(&workshop, "assemble", &["render", "scene.glb", "--from", "1,2,3"]);
    assert_eq!(
        workshop.files("").keys().collect::<Vec<_>>(),
        before.keys().collect::<Vec<_>>(),
        "files after"
    );
}

fn refused(workshop: &Workshop, program: &str, arguments: &[&str]) {
    let ended = workshop.run(program, arguments);
    assert_eq!(ended.code, Some(2), "{program} {arguments:?}: {}", ended.stderr);
    assert!(ended.stdout.is_empty(), "{program} {arguments:?} prints on stdout: {}", ended.stdout);
    assert!(
        ended.stderr.contains("--help"),
        "{program} {arguments:?} does not point to help: {}",
        ended.stderr
    );
}
