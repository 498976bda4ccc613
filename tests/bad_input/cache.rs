//! A damaged cache costs time and a note, never a wrong answer.

use equilux_tests::rooms::furnished;
use equilux_tests::workshop::Workshop;
use serde_json::Value;
use std::path::PathBuf;

const ARGUMENTS: [&str; 8] =
    ["scene.glb", "--element-size", "1", "--rounds", "3", "--cache", "cache", "--json"];

/// What happens to a file's bytes.
type Damage = fn(&mut Vec<u8>);

fn report(workshop: &Workshop) -> Value {
    let ended = workshop.run("assemble", &ARGUMENTS);
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    serde_json::from_str(&ended.stdout).expect("a report")
}

#[test]
fn damaged_cache_files_are_noted_and_made_again() {
    let workshop = Workshop::with(&furnished());
    let before = report(&workshop);
    let files = workshop.files("cache");
    let damages: [(&str, Damage); 3] = [
        ("truncated", |bytes| bytes.truncate(bytes.len() * 2 / 3)),
        ("a flipped bit", |bytes| {
            let middle = bytes.len() / 2;
            bytes[middle] ^= 1;
        }),
        ("emptied", Vec::clear),
    ];
    for (damage, apply) in damages {
        for (path, whole) in &files {
            let mut bytes = whole.clone();
            apply(&mut bytes);
            std::fs::write(path, bytes).expect("a written file");
        }
        let after = report(&workshop);
        assert_eq!(after["energy"], before["energy"], "{damage}: light");
        assert_eq!(after["form_factors_computed"], before["form_factors_computed"], "{damage}: form factors");
        assert_noted(&after, damage, files.keys().filter(|path| !is_manifest(path)).cloned().collect());
        assert_eq!(workshop.files("cache"), files, "{damage}: the cache afterwards");
        let healed = report(&workshop);
        assert_eq!(healed["form_factors_computed"], 0, "{damage}: form factors in the run after");
        assert!(
            !healed["notes"].to_string().contains(".eqx"),
            "{damage}: run after notes {}",
            healed["notes"]
        );
    }
}

/// Manifests only serve to explain; a damaged one is as good as none.
fn is_manifest(path: &std::path::Path) -> bool {
    path.file_name().is_some_and(|name| name.to_string_lossy().starts_with("manifest"))
}

fn assert_noted(report: &Value, damage: &str, paths: Vec<PathBuf>) {
    assert!(paths.len() > 8, "{damage}: only {paths:?} in the cache");
    let notes = report["notes"].to_string();
    for path in paths {
        let name = path.file_name().expect("a name").to_string_lossy();
        assert!(notes.contains(&*name), "{damage}: {name} is not in the notes {notes}");
    }
}

#[test]
fn bake_notes_a_damaged_cache_too() {
    let workshop = Workshop::with(&furnished());
    let bake = || workshop.run("bake", &["scene.glb", "--element-size", "1", "--cache", "cache"]);
    assert_eq!(bake().code, Some(0));
    workshop.files("cache").keys().for_each(|path| std::fs::write(path, "moth").expect("a written file"));
    let again = bake();
    assert_eq!(again.code, Some(0), "{}", again.stderr);
    assert!(again.stderr.contains("note: cache/part-"), "no note about the cache: {}", again.stderr);
    assert!(again.stdout.contains("4 baked, 0 reused"), "{}", again.stdout);
}
