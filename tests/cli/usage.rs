//! Help with examples, and exit code 2 for faulty command lines.

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
    let message = "error: .: a folder with several scenes, other.glb, scene.glb; ";
    assert!(ended.stderr.starts_with(message) && ended.stderr.contains("name a file"), "{}", ended.stderr);
}

#[test]
fn a_folder_without_a_scene_says_so() {
    let workshop = Workshop::new();
    std::fs::create_dir_all(workshop.path("empty/scene.glb")).expect("folders");
    for command in [&[][..], &["plan"], &["render"], &["classic"], &["sweep"]] {
        let ended = workshop.run("assemble", &[command, &["empty"]].concat());
        assert_eq!(ended.code, Some(1), "{command:?}: {}", ended.stderr);
        let message = "error: empty: a folder without a .gltf or .glb file in it; ";
        assert!(ended.stderr.starts_with(message), "{command:?}: {}", ended.stderr);
    }
}

/// Common mistakes, and the suggested corrections.
#[test]
fn a_slip_gets_a_suggestion() {
    let workshop = Workshop::with(&square());
    for (program, arguments, suggestion) in [
        ("assemble", &["pln"][..], "did you mean `plan`?"),
        ("assemble", &["pln", "scene.glb"], "did you mean `plan`?"),
        ("assemble", &["rendr", "scene.glb", "--size", "8x8"], "did you mean `render`?"),
        ("bake", &["completons", "bash"], "did you mean `completions`?"),
        ("bake", &["scene.glb", "--element-size", "10cm"], "for 10cm write 0.1"),
        ("assemble", &["scene.glb", "--element-size", "10mm"], "for 10mm write 0.01"),
        ("assemble", &["plan", "scene.glb", "--element-size", "2ft"], "for 2ft write 0.6096"),
        ("assemble", &["classic", "scene.glb", "--element-size", "50cm"], "for 50cm write 0.5"),
        ("assemble", &["scene.glb", "--lightmaps", "--texel-size", "4 cm"], "for 4 cm write 0.04"),
        ("assemble", &["scene.glb", "--cut", "x=150cm"], "for x=150cm write x=1.5"),
        ("assemble", &["render", "scene.glb", "--from", "1m,1.6m,2m", "--to", "0,0,0"], "write 1,1.6,2"),
        ("bake", &["scene.glb", "--cache-limit", "2"], "write 2GB, 2MB or 2B"),
        ("assemble", &["scene.glb", "--cache-limit", "1.5"], "write 1.5GB, 1.5MB or 1.5B"),
    ] {
        let ended = workshop.run(program, arguments);
        let what = format!("{program} {arguments:?}: {}", ended.stderr);
        assert_eq!(ended.code, Some(2), "{what}");
        assert!(ended.stderr.contains(suggestion), "no '{suggestion}' in {what}");
    }
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
