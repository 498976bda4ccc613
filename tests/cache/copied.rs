//! A cache depends on content, not on paths: it can be copied, with or without its scenes.

use super::told;
use equilux_tests::rooms::furnished;
use equilux_tests::workshop::Workshop;
use std::path::Path;

fn copy(from: &Path, to: &Path) {
    std::fs::create_dir_all(to).expect("a folder");
    for entry in from.read_dir().expect("a folder to copy") {
        let entry = entry.expect("a readable folder");
        let target = to.join(entry.file_name());
        match entry.path() {
            folder if folder.is_dir() => copy(&folder, &target),
            file => drop(std::fs::copy(file, target).expect("a copy")),
        }
    }
}

#[test]
fn a_copied_cache_serves_a_copied_scene() {
    let here = Workshop::with(&furnished());
    let options = ["--element-size", "1", "--rounds", "2", "--cache"];
    let first = told(&here, "assemble", &[&["scene.glb"], &options[..], &["cache"]].concat());

    let there = Workshop::new();
    copy(&here.path("cache"), &there.path("of/a/friend"));
    copy(&here.path(""), &there.path("level"));
    drop(here);
    let made = there.files("of/a/friend");
    let second = told(&there, "assemble", &[&["level/scene.glb"], &options[..], &["of/a/friend"]].concat());
    assert_ne!(first["form_factors_computed"], 0, "at first");
    assert_eq!(second["form_factors_computed"], 0, "from the copy");
    assert_eq!(second["energy"], first["energy"], "light from the copy");
    let added: Vec<_> =
        there.files("of/a/friend").into_keys().filter(|path| !made.contains_key(path)).collect();
    // Latest manifests depend on the scene's path; they only explain changes.
    let memory = |path: &Path| path.file_name().is_some_and(|n| n.to_string_lossy().starts_with("manifest-"));
    assert!(added.iter().all(|path| memory(path)), "made anew: {added:?}");

    let batch = told(&there, "bake", &["level/scene.glb", "--element-size", "1", "--cache", "of/a/friend"]);
    let baked = &batch["files"][0]["parts"];
    assert!(baked.as_array().is_some_and(|p| p.iter().all(|part| part["baked"] == false)), "{baked}");
}
