//! Impossible scenes are refused with an error that names file and remedy, and nothing is written.

use equilux_formats::{Material, Rgb};
use equilux_tests::model::{Model, Node};
use equilux_tests::rooms::{furnished, lamp, square};
use equilux_tests::shapes::room;
use equilux_tests::workshop::Workshop;
use glam::DVec3;
use serde_json::json;

/// A file, options, and words of the message: what was found and what to do.
struct Case {
    name: &'static str,
    scene: Vec<u8>,
    options: &'static [&'static str],
    words: [&'static str; 2],
}

fn case(name: &'static str, scene: impl Into<Vec<u8>>, words: [&'static str; 2]) -> Case {
    Case { name, scene: scene.into(), options: &["--element-size", "1"], words }
}

fn cases() -> Vec<Case> {
    let square = || Model::of(&square());
    let mut not_a_number = square();
    not_a_number.binary[4..8].copy_from_slice(&f32::NAN.to_le_bytes());
    let whole = square().bytes();
    let colour = "/materials/0/pbrMetallicRoughness/baseColorFactor";
    vec![
        case("text", "once upon a time", ["glTF", "export"]),
        case("nothing", "", ["glTF", "export"]),
        case("half a file", &whole[..whole.len() / 2], ["scene.glb", "export"]),
        case("a position that is no number", not_a_number.bytes(), ["vertex", "mesh"]),
        case(
            "positions past the end",
            square().with("/accessors/0/count", json!(999)).bytes(),
            ["999 elements reach past", "export"],
        ),
        case(
            "an index to nowhere",
            square().with("/nodes/0/mesh", json!(7)).bytes(),
            ["out of bounds", "export"],
        ),
        case(
            "a cycle of nodes",
            square().with("/nodes/0/children", json!([0])).bytes(),
            ["below itself, a cycle", "remove the node"],
        ),
        case("an empty scene", Model::of(&[]).bytes(), ["no surfaces", "add"]),
        case(
            "more light than arrives",
            square().with(colour, json!([1.5, 1, 1, 1])).bytes(),
            ["reflectance rho [1.5", "baseColorFactor"],
        ),
        case(
            "a furnace that never ends",
            Model::of(&[furnace()]).bytes(),
            ["without end", "lower a base colour"],
        ),
    ]
    .into_iter()
    .chain(files_and_sizes())
    .collect()
}

/// Part files that do not exist or may not be read, and scenes with too many elements.
fn files_and_sizes() -> Vec<Case> {
    let square = || Model::of(&square());
    vec![
        case(
            "a part outside the folder",
            Model::of(&[Node::of_file("lamp", "../lamp.glb")]).bytes(),
            ["leaves the scene's folder", "move that file"],
        ),
        case(
            "a part that is not there",
            Model::of(&[Node::of_file("lamp", "parts/lamp.glb")]).bytes(),
            ["parts/lamp.glb", "put the file there"],
        ),
        Case {
            options: &["--element-size", "1e-5"],
            ..case("dust", Model::of(&furnished()).bytes(), ["at most 4e6 elements", "--element-size"])
        },
        Case {
            options: &["--element-size", "1e-5"],
            ..case("dust, counted", square().bytes(), ["has 10000000000 of them", "larger elements"])
        },
        case(
            "dust that its author asked for",
            square().with("/nodes/0/extras", json!({ "element_size": 1e-5 })).bytes(),
            ["has 10000000000 of them", "a larger element_size in the extras"],
        ),
    ]
}

#[test]
fn scenes_that_cannot_be_are_refused_and_nothing_is_written() {
    for case in cases() {
        for program in ["bake", "assemble"] {
            let workshop = Workshop::new();
            std::fs::write(workshop.path("scene.glb"), &case.scene).expect("a written file");
            let ended = workshop.run(program, &[&["scene.glb"], case.options].concat());
            let what = format!("{program}, {}: {}", case.name, ended.stderr);
            assert_eq!(ended.code, Some(1), "{what}");
            assert_eq!(ended.stderr.lines().count(), 1, "one sentence: {what}");
            for words in ["error: scene.glb: ", "; expected "].iter().chain(&case.words) {
                assert!(ended.stderr.contains(words), "no '{words}' in {what}");
            }
            let files = workshop.files("");
            let strange: Vec<_> = files.keys().filter(|path| !is_input_or_cached(path)).collect();
            assert!(strange.is_empty(), "{what} left {strange:?}");
            println!("{what}");
        }
    }
}

/// A furnace is detected by its form factors, which may stay in the cache.
fn is_input_or_cached(path: &std::path::Path) -> bool {
    path.ends_with("scene.glb") || path.components().any(|folder| folder.as_os_str() == ".equilux")
}

/// A closed room that emits and reflects everything.
fn furnace() -> Node {
    let white = Material { reflectance: Rgb([1.0; 3]), ..lamp([1.0; 3]) };
    Node::new("furnace", room(white, DVec3::ZERO, DVec3::ONE))
}

#[test]
fn clusters_do_not_open_a_furnace() {
    let workshop = Workshop::with(&[furnace()]);
    // Rows of a few clusters in steps sum to one only within some 1e-6.
    for tolerance in ["0.3", "0.01"] {
        let arguments = ["scene.glb", "--element-size", "0.1", "--tolerance", tolerance];
        let ended = workshop.run("assemble", &arguments);
        assert_eq!(ended.code, Some(1), "tolerance {tolerance}: {}", ended.stderr);
        assert!(ended.stderr.contains("light grows without end"), "{}", ended.stderr);
    }
}

#[test]
fn a_missing_file_and_an_empty_folder_are_named() {
    let workshop = Workshop::new();
    std::fs::create_dir(workshop.path("empty")).expect("a folder");
    for (program, input, words) in [
        ("assemble", "nowhere.glb", "error: nowhere.glb: cannot be read"),
        ("bake", "nowhere.glb", "error: nowhere.glb: cannot be read"),
        ("assemble", "empty", "error: empty: "),
        ("bake", "empty", "error: empty: no .gltf or .glb file"),
    ] {
        let ended = workshop.run(program, &[input]);
        assert_eq!(ended.code, Some(1), "{program} {input}: {}", ended.stderr);
        assert!(ended.stderr.starts_with(words), "{program} {input}: no '{words}' in {}", ended.stderr);
        println!("{program} {input}: {}", ended.stderr);
    }
}

#[test]
fn a_bad_file_does_not_keep_bake_from_the_others() {
    let workshop = Workshop::with(&square());
    std::fs::write(workshop.path("bad.glb"), "once upon a time").expect("a written file");
    let ended = workshop.run("bake", &["bad.glb", "scene.glb", "--element-size", "1"]);
    assert_eq!(ended.code, Some(1), "{}", ended.stderr);
    assert!(ended.stderr.contains("bad.glb: "), "{}", ended.stderr);
    assert!(ended.stdout.contains("scene.glb: square: "), "{}", ended.stdout);
}
