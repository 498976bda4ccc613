//! Robustness of the cache folder: killed processes, concurrent processes, damaged files, and limited size.

use equilux_formats::baked::{BakedLight, BoundaryResponses, LocalEquilibrium};
use equilux_formats::container::Kind;
use equilux_formats::fingerprint::{Content, Key, Manifest};
use equilux_formats::store::{Evicted, Lookup, Tally};
use equilux_formats::whole_file::{remove_left_over_beside, write_whole};
use equilux_formats::{LocalSolver, Optics, Rgb, Rows, Store};
use std::collections::HashSet;
use std::fs::{self, File};
use std::path::{Path, PathBuf};
use std::time::{Duration, SystemTime};
use tempfile::TempDir;

fn folder() -> TempDir {
    tempfile::tempdir().unwrap()
}

fn manifest(number: usize) -> Manifest {
    Manifest::new().setting("number", number)
}

fn coupling() -> Rows {
    Rows::from_rows(3, [vec![(1, 0.1 + 0.2)], vec![(0, 1e-300), (1, 0.0)]])
}

fn light() -> BakedLight {
    let optics =
        Optics { reflectance: vec![Rgb([0.5, 0.25, 0.5])], emission: vec![Rgb([10.0, 1e12, 1e-12])] };
    let local = LocalEquilibrium {
        solver: LocalSolver::Iterative,
        radiosity: vec![Rgb([1.0 / 3.0; 3])],
        factors: None,
        answers: BoundaryResponses::default(),
    };
    BakedLight { optics, local }
}

fn names(folder: &Path) -> Vec<String> {
    let entries = fs::read_dir(folder).unwrap();
    let mut names: Vec<_> = entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    names
}

/// The file of a process that was killed while writing.
fn left_over(folder: &Path) -> PathBuf {
    let path = folder.join(".equilux-Ab3xYz.tmp");
    fs::write(&path, "half").unwrap();
    path
}

#[test]
fn what_a_killed_process_left_goes_and_what_is_being_written_stays() {
    let folder = folder();
    let mine = folder.path().join(".other.tmp");
    fs::write(&mine, "not ours").unwrap();
    left_over(folder.path());
    Store::open(folder.path()).unwrap();
    assert_eq!(names(folder.path()), [".other.tmp"], "after the store was opened");

    left_over(folder.path());
    let path = folder.path().join("whole.txt");
    write_whole(&path, |out| {
        assert_eq!(names(folder.path()).len(), 3, "the left over file, the one being written, another's");
        remove_left_over_beside(&path);
        assert_eq!(names(folder.path()).len(), 2, "the one being written and another's");
        out.write_all(b"whole")
    })
    .unwrap();
    assert_eq!(names(folder.path()), [".other.tmp", "whole.txt"]);
    assert_eq!(fs::read(&path).unwrap(), b"whole");
}

/// Every file exists in the end, although other processes may remove it before it is locked.
#[test]
fn writers_and_sweepers_do_not_disturb_each_other() {
    let folder = folder();
    let path = |writer: usize, file: usize| folder.path().join(format!("{writer}-{file}.txt"));
    std::thread::scope(|scope| {
        let writers: Vec<_> = (0..3)
            .map(|writer| {
                scope.spawn(move || {
                    (0..200).for_each(|file| {
                        write_whole(&path(writer, file), |out| out.write_all(b"!")).unwrap()
                    });
                })
            })
            .collect();
        while !writers.iter().all(|writer| writer.is_finished()) {
            remove_left_over_beside(&path(0, 0));
        }
    });
    assert_eq!(names(folder.path()).len(), 600, "files of three writers");
}

#[test]
fn one_at_a_time_has_the_turn_for_a_key() {
    let folder = folder();
    let (mine, yours) = (Store::open(folder.path()).unwrap(), Store::open(folder.path()).unwrap());
    let key = manifest(0).key();
    let turn = mine.try_turn(&key).expect("nobody else wants it");
    assert!(yours.try_turn(&key).is_none(), "two have the turn");
    let first_byte = |key: &Key| key.to_string()[..2].to_string();
    let other = (1..).map(|n| manifest(n).key()).find(|other| first_byte(other) != first_byte(&key)).unwrap();
    assert!(yours.try_turn(&other).is_some(), "another key waits too");
    drop(turn);
    assert!(yours.try_turn(&key).is_some(), "the turn never ends");
}

#[test]
fn without_locks_everybody_has_a_turn() {
    let folder = folder();
    let store = Store::open(folder.path()).unwrap();
    fs::write(folder.path().join("locks"), "a file where the folder should be").unwrap();
    let turns = [store.try_turn(&manifest(0).key()), store.try_turn(&manifest(0).key())];
    assert!(turns.iter().all(Option::is_some), "{turns:?}");
}

/// Each kind of file: with one byte changed at any place, or cut anywhere, nothing is loaded and the damage is reported.
#[test]
fn no_damage_to_a_file_of_any_kind_is_believed() {
    let folder = folder();
    let store = Store::open(folder.path()).unwrap();
    let manifest = manifest(0);
    store.save(&manifest, &light()).unwrap();
    store.save(&manifest, &coupling()).unwrap();
    store.remember("name", &manifest).unwrap();
    let remembered = store.path(Kind::Manifest, Content::new().bytes("name").digest());

    damage(&store.path(Kind::Light, manifest.key()), |how| {
        let found = store.load::<BakedLight>(&manifest.key());
        assert!(matches!(found, Lookup::Damaged(_)), "light, {how}: {found:?}");
        assert_eq!(store.take_damages().len(), 1, "light, {how}: damages told of");
    });
    damage(&store.path(Kind::Coupling, manifest.key()), |how| {
        let found = store.load::<Rows>(&manifest.key());
        assert!(matches!(found, Lookup::Damaged(_)), "coupling, {how}: {found:?}");
        assert_eq!(store.take_damages().len(), 1, "coupling, {how}: damages told of");
    });
    damage(&remembered, |how| assert_eq!(store.last_manifest("name"), None, "manifest, {how}"));
    assert_eq!(store.last_manifest("name"), Some(manifest), "the undamaged file");
}

fn damage(path: &Path, assert_found: impl Fn(&str)) {
    let whole = fs::read(path).unwrap();
    for position in 0..whole.len() {
        let mut flipped = whole.clone();
        flipped[position] ^= 1 << (position % 8);
        fs::write(path, flipped).unwrap();
        assert_found(&format!("byte {position} flipped"));
        fs::write(path, &whole[..position]).unwrap();
        assert_found(&format!("cut to {position} bytes"));
    }
    fs::write(path, whole).unwrap();
}

#[test]
fn a_damage_seen_twice_is_told_of_once() {
    let folder = folder();
    let store = Store::open(folder.path()).unwrap();
    store.save(&manifest(0), &coupling()).unwrap();
    fs::write(store.path(Kind::Coupling, manifest(0).key()), "moth").unwrap();
    for _ in 0..2 {
        assert!(matches!(store.load::<Rows>(&manifest(0).key()), Lookup::Damaged(_)));
    }
    assert_eq!(store.take_damages().len(), 1);
}

#[test]
fn keeping_only_some_keys_drops_all_else_that_a_store_made() {
    let folder = folder();
    let store = Store::open(folder.path()).unwrap();
    for number in 0..3 {
        store.save(&manifest(number), &coupling()).unwrap();
        store.remember(&format!("thing {number}"), &manifest(number)).unwrap();
    }
    store.save(&manifest(1), &light()).unwrap();
    for foreign in ["notes.txt", "part-of-a-book.eqx"] {
        fs::write(folder.path().join(foreign), "mine").unwrap();
    }
    let evicted = store.keep_only(&HashSet::from([manifest(1).key()])).unwrap();
    assert_eq!(
        (evicted.dropped.files, evicted.kept.files),
        (4, 3),
        "two couplings and what was noted of them go"
    );
    assert!(matches!(store.load::<Rows>(&manifest(1).key()), Lookup::Found(_)));
    assert!(matches!(store.load::<BakedLight>(&manifest(1).key()), Lookup::Found(_)));
    assert_eq!(store.last_manifest("thing 1"), Some(manifest(1)));
    assert!(matches!(store.load::<Rows>(&manifest(0).key()), Lookup::Missing));
    assert_eq!(store.last_manifest("thing 0"), None);
    let bytes: u64 = evicted.kept.bytes;
    let there: u64 = fs::read_dir(folder.path()).unwrap().map(|e| e.unwrap().metadata().unwrap().len()).sum();
    assert_eq!(bytes, there - 8, "all but the two foreign files of four bytes, no longer a lock");
}

#[test]
fn a_limit_drops_what_was_not_used_for_longest_and_never_what_is_in_use() {
    let folder = folder();
    let earlier = Store::open(folder.path()).unwrap();
    let mut size = 0;
    for number in 0..4 {
        earlier.save(&manifest(number), &coupling()).unwrap();
        let path = earlier.path(Kind::Coupling, manifest(number).key());
        size = path.metadata().unwrap().len();
        // The last saved was used longest ago.
        let hours = Duration::from_secs(3600 * (1 + number as u64));
        File::options().append(true).open(path).unwrap().set_modified(SystemTime::now() - hours).unwrap();
    }
    let store = Store::open(folder.path()).unwrap();
    assert!(matches!(store.load::<Rows>(&manifest(2).key()), Lookup::Found(_)));
    let there = |store: &Store| {
        (0..4).filter(|&n| store.path(Kind::Coupling, manifest(n).key()).exists()).collect::<Vec<_>>()
    };
    let of = |files: usize| Tally { files, bytes: files as u64 * size };

    assert_eq!(store.limit(4 * size).unwrap(), Evicted { dropped: of(0), kept: of(4) });
    assert_eq!(store.limit(3 * size).unwrap(), Evicted { dropped: of(1), kept: of(3) });
    assert_eq!(there(&store), [0, 1, 2], "3 was used longest ago");
    assert_eq!(store.limit(2 * size + 1).unwrap(), Evicted { dropped: of(1), kept: of(2) });
    assert_eq!(there(&store), [0, 2], "2 was just used");
    assert_eq!(store.limit(0).unwrap(), Evicted { dropped: of(1), kept: of(1) });
    assert_eq!(there(&store), [2], "2 is in use");
    assert_eq!(Store::open(folder.path()).unwrap().limit(0).unwrap().kept, of(0), "of a run that used none");
}
