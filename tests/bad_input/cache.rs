//! A damaged cache costs time and a note, never a wrong answer.

use equilux_formats::baked::{BakedGeometry, BakedLight};
use equilux_formats::container::{Kind, Reader};
use equilux_formats::stored::Stored;
use equilux_formats::{Rows, SourceRows};
use equilux_tests::rooms::furnished;
use equilux_tests::workshop::Workshop;
use serde_json::Value;
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

const ARGUMENTS: [&str; 10] =
    ["scene.glb", "--element-size", "1", "--rounds", "1", "--cache", "cache", "--exact-rows", "0", "--json"];

/// The damage of a file.
type Damage = fn(&mut Vec<u8>);

fn report(workshop: &Workshop) -> Value {
    let ended = workshop.run("assemble", &ARGUMENTS);
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    serde_json::from_str(&ended.stdout).expect("a report")
}

/// All that lies in the cache but the locks, which are empty.
fn cached(workshop: &Workshop) -> BTreeMap<PathBuf, Vec<u8>> {
    let mut files = workshop.files("cache");
    files.retain(|path, _| path.extension().is_some_and(|ending| ending == "eqx"));
    files
}

#[test]
fn damaged_cache_files_are_noted_and_made_again() {
    let workshop = Workshop::with(&furnished());
    let before = report(&workshop);
    let files = cached(&workshop);
    let damages: [(&str, Damage); 5] = [
        ("truncated", |bytes| bytes.truncate(bytes.len() * 2 / 3)),
        ("a flipped bit", |bytes| {
            let middle = bytes.len() / 2;
            bytes[middle] ^= 1;
        }),
        ("of a version to come", |bytes| bytes[8] += 1),
        ("a picture", |bytes| bytes[..8].copy_from_slice(b"\x89PNG\r\n\x1a\n")),
        ("emptied", Vec::clear),
    ];
    for (damage, apply) in damages {
        for (path, whole) in &files {
            let mut bytes = whole.clone();
            apply(&mut bytes);
            std::fs::write(path, bytes).expect("a written file");
        }
        assert_healed(&workshop, &before, &files, damage);
    }
}

/// Whole files, each with right checksums, under the names of others of their kind.
#[test]
fn exchanged_cache_files_are_noted_and_made_again() {
    let workshop = Workshop::with(&furnished());
    let before = report(&workshop);
    let files = cached(&workshop);
    let kind = |path: &Path| {
        path.file_name().expect("a name").to_string_lossy().split('-').next().map(str::to_owned)
    };
    for (path, whole) in &files {
        let mut others = files.iter().filter(|(other, bytes)| kind(other) == kind(path) && *bytes != whole);
        let (_, bytes) = others.next().expect("another of its kind");
        std::fs::write(path, bytes).expect("a written file");
    }
    assert_healed(&workshop, &before, &files, "exchanged");
}

/// The next run has the results of the one before the damage, reports the damage, and repairs the cache.
fn assert_healed(workshop: &Workshop, before: &Value, files: &BTreeMap<PathBuf, Vec<u8>>, damage: &str) {
    let after = report(workshop);
    assert_eq!(after["energy"], before["energy"], "{damage}: light");
    assert_eq!(after["form_factors_computed"], before["form_factors_computed"], "{damage}: form factors");
    assert_noted(&after, damage, files.keys().filter(|path| !is_manifest(path)).cloned().collect());
    assert_eq!(cached(workshop), *files, "{damage}: the cache afterwards");
    let healed = report(workshop);
    assert_eq!(healed["form_factors_computed"], 0, "{damage}: form factors in the run after");
    assert!(!healed["notes"].to_string().contains(".eqx"), "{damage}: run after notes {}", healed["notes"]);
}

/// Number of positions in each file.
const PLACES: usize = 100;

/// Files of every kind as the programs make them, changed in one byte or cut: the damage is always detected.
#[test]
fn no_damage_to_any_file_of_a_real_cache_is_believed() {
    let workshop = Workshop::with(&furnished());
    report(&workshop);
    let mut kinds = BTreeSet::new();
    for (path, whole) in cached(&workshop) {
        let name = path.file_name().expect("a name").to_string_lossy().into_owned();
        let refused: fn(&Path) -> bool = match name.split('-').next().expect("a kind") {
            "part" => is_refused::<BakedGeometry>,
            "light" => is_refused::<BakedLight>,
            "coupling" => is_refused::<Rows>,
            "sources" => is_refused::<SourceRows>,
            "manifest" => |path| Reader::open(path, Kind::Manifest).is_err(),
            kind => panic!("{name} is of no known kind: {kind}"),
        };
        assert!(!refused(&path), "{name} as it was made");
        kinds.insert(name.split('-').next().map(str::to_owned));
        // A stride without a common divisor with the fields' widths.
        for position in (0..whole.len()).step_by((whole.len() / PLACES) | 1) {
            let mut flipped = whole.clone();
            flipped[position] ^= 1 << (position % 8);
            replace(&path, &flipped);
            assert!(refused(&path), "{name} with byte {position} of {} changed", whole.len());
            replace(&path, &whole[..position]);
            assert!(refused(&path), "{name} cut to {position} of {} bytes", whole.len());
        }
    }
    assert_eq!(kinds.len(), 5, "kinds of files tried: {kinds:?}");
}

/// A new file each time: some file systems wait for the disk when a file is cut and filled again.
fn replace(path: &Path, bytes: &[u8]) {
    std::fs::remove_file(path).and_then(|()| std::fs::write(path, bytes)).expect("a written file");
}

fn is_refused<T: Stored>(path: &Path) -> bool {
    Reader::open(path, T::KIND).and_then(|mut reader| T::read(&mut reader)).is_err()
}

/// Manifests only serve to explain; a damaged one is as good as none.
fn is_manifest(path: &Path) -> bool {
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
    cached(&workshop).keys().for_each(|path| std::fs::write(path, "moth").expect("a written file"));
    let again = bake();
    assert_eq!(again.code, Some(0), "{}", again.stderr);
    assert!(again.stderr.contains("note: cache/part-"), "no note about the cache: {}", again.stderr);
    assert!(again.stdout.contains("4 baked, 0 reused"), "{}", again.stdout);
}
