//! What the cache promises: what comes back is what was put in, to the last bit, or a sentence that says why not.

use equilux_formats::{
    Answers, BakedGeometry, BakedLight, ClusterTree, Content, Corners, Element, Error, FORMAT_VERSION, Face,
    FaceId, Factors, Geometry, Kind, LocalEquilibrium, LocalSolver, Lookup, Lu, Manifest, MaterialId, Optics,
    Precision, Reader, Rgb, RowGroup, Rows, Store, Stored, Writer,
};
use glam::DVec3;
use proptest::prelude::*;
use std::fmt::Debug;
use std::path::{Path, PathBuf};
use tempfile::TempDir;

fn manifest() -> Manifest {
    Manifest::new()
        .setting("kernel", 1)
        .digest("geometry of hall", Content::new().f64s(&[1.0, 2.0]).digest())
        .setting("element size", "0.25 m")
}

/// A quad and a triangle far from the origin, in coordinates that no short decimal has.
fn part() -> BakedGeometry {
    let at = |x: f64, y: f64| DVec3::new(x / 3.0 + 1e4, y / 7.0 - 0.1, -0.0);
    let quad = [at(0.0, 0.0), at(1.0, 0.0), at(1.0, 1.0), at(0.0, 1.0)];
    let triangle = [at(2.0, 0.0), at(3.0, 0.0), at(2.0, 1.0)];
    let elements = vec![
        Element::new(Corners::quad(quad), MaterialId(0), FaceId(0)),
        Element::new(Corners::triangle(triangle).flipped(), MaterialId(1), FaceId(1)),
    ];
    let faces = vec![Face::new(quad.to_vec()), Face::new(triangle.to_vec())];
    let areas: Vec<f64> = elements.iter().map(|element| element.area).collect();
    let clusters = ClusterTree::new(&areas, vec![[0, 1]]).unwrap();
    let self_block = Rows::from_rows(3, [vec![(1, 0.1 + 0.2)], vec![(0, 1e-300), (1, 0.0)]]);
    BakedGeometry { geometry: Geometry { elements, faces, clusters }, self_block }
}

fn light() -> BakedLight {
    let lu = |pivot| Lu { size: 2, packed: vec![pivot, 0.5, -0.25, 0.75], rows: vec![1, 0] };
    let factors = Some(Factors { channels: vec![lu(1.0), lu(0.9)], of_channel: [0, 1, 0] });
    let optics = Optics {
        reflectance: vec![Rgb([0.5, 0.25, 0.5]); 2],
        emission: vec![Rgb::BLACK, Rgb([10.0, 1e12, 1e-12])],
    };
    let answers = Answers {
        radiosity: vec![vec![Rgb([0.5, 0.25, 0.0]); 2]],
        matrix: vec![Rgb([0.125, 1e-9, 0.0])],
        returned: Rgb([0.75, 0.5, 0.0]),
    };
    let radiosity = vec![Rgb::splat(1.0 / 3.0); 2];
    let local = LocalEquilibrium { solver: LocalSolver::Direct, radiosity, factors, answers };
    BakedLight { optics, local }
}

fn coupling() -> Rows {
    let together = RowGroup { columns: vec![0, 4], values: vec![0.125, 1e-9, 0.0, 0.25], receivers: 2 };
    let alone = RowGroup { columns: vec![2], values: vec![1.0], receivers: 1 };
    Rows::from_groups(5, [together, alone], Precision::Single)
}

fn folder() -> TempDir {
    tempfile::tempdir().unwrap()
}

fn written<T: Stored>(folder: &TempDir, value: &T) -> (PathBuf, Vec<u8>) {
    let path = folder.path().join("whole.eqx");
    value.write(&manifest()).write_to(&path).unwrap();
    let bytes = std::fs::read(&path).unwrap();
    (path, bytes)
}

fn read<T: Stored>(path: &Path) -> Result<T, Error> {
    T::read(&mut Reader::open(path, T::KIND)?)
}

fn read_bytes<T: Stored>(folder: &TempDir, bytes: &[u8]) -> Result<T, Error> {
    let path = folder.path().join("changed.eqx");
    std::fs::write(&path, bytes).unwrap();
    read(&path)
}

/// Every harm that one byte can do to the file of `value` is found out.
fn damage_is_found<T: Stored + Debug>(value: &T) {
    let folder = folder();
    let (path, bytes) = written(&folder, value);
    // As text, for −0 and 0 are equal but not the same.
    assert_eq!(format!("{:?}", read::<T>(&path).unwrap()), format!("{value:?}"));

    for position in 0..bytes.len() {
        let mut flipped = bytes.clone();
        flipped[position] ^= 1 << (position % 8);
        let error = read_bytes::<T>(&folder, &flipped).expect_err(&format!("byte {position} flipped"));
        assert!(error.to_string().ends_with("; bake it again"), "{error}");
        read_bytes::<T>(&folder, &bytes[..position]).expect_err(&format!("cut to {position} bytes"));
    }
    for more in [vec![0], vec![0xFF; 7], bytes.clone()] {
        let error = read_bytes::<T>(&folder, &[&bytes[..], &more].concat()).expect_err("trailing bytes");
        assert!(error.to_string().contains(&format!("{} bytes", bytes.len())), "{error}");
    }
}

#[test]
fn any_flipped_byte_cut_or_addition_is_found() {
    damage_is_found(&part());
    damage_is_found(&light());
    damage_is_found(&coupling());
}

#[test]
fn foreign_files_are_named_as_such() {
    let folder = folder();
    let (path, bytes) = written(&folder, &coupling());

    let mut newer = bytes.clone();
    newer[8..12].copy_from_slice(&(FORMAT_VERSION + 6).to_le_bytes());
    let message = read_bytes::<Rows>(&folder, &newer).unwrap_err().to_string();
    for part in ["changed.eqx", "format version 10", "expected version 4", "bake it again"] {
        assert!(message.contains(part), "{part:?} is not in {message:?}");
    }

    let picture = [b"\x89PNG\r\n\x1a\n", &[0; 100][..]].concat();
    let message = read_bytes::<Rows>(&folder, &picture).unwrap_err().to_string();
    assert!(message.contains("not an Equilux file; expected an Equilux coupling file"), "{message}");

    let message = read::<BakedLight>(&path).unwrap_err().to_string();
    assert!(message.contains("kind COUP; expected kind LGHT, a light file"), "{message}");
    assert!(read::<Rows>(folder.path()).unwrap_err().to_string().contains("not a regular file"));
}

#[derive(serde::Serialize)]
struct Index {
    manifest: Manifest,
    arrays: Vec<Entry>,
}

#[derive(serde::Serialize)]
struct Entry {
    name: &'static str,
    number: &'static str,
    count: u64,
    length: u64,
    checksum: [u8; 32],
}

/// A coupling file of one array, put together as FORMAT.md says and by none of the library's code.
fn by_hand(count: u64, length: impl Fn(u64) -> u64) -> Vec<u8> {
    let numbers: Vec<u8> = [1.5f64, -2.0, 0.0].iter().flat_map(|number| number.to_le_bytes()).collect();
    let frame = zstd::encode_all(&numbers[..], 1).unwrap();
    let checksum = *blake3::hash(&frame).as_bytes();
    let entry = Entry { name: "numbers", number: "f64", count, length: length(frame.len() as u64), checksum };
    let index = Index { manifest: manifest(), arrays: vec![entry] };
    let messages = [rmp_serde::to_vec_named(&index).unwrap(), vec![0xC0]].concat();
    let header = [&b"EQUILUX\0\x04\0\0\0COUP"[..], &(messages.len() as u64).to_le_bytes()].concat();
    let checksum = *blake3::hash(&[&header[..], &messages].concat()).as_bytes();
    [&header[..], &checksum, &messages, &frame].concat()
}

fn numbers_by_hand(count: u64, length: impl Fn(u64) -> u64) -> Result<Vec<f64>, Error> {
    let folder = folder();
    let path = folder.path().join("by-hand.eqx");
    std::fs::write(&path, by_hand(count, length)).unwrap();
    Reader::open(&path, Kind::Coupling)?.array("numbers")
}

#[test]
fn a_file_made_by_hand_from_the_description_is_read() {
    assert_eq!(numbers_by_hand(3, |length| length).unwrap(), [1.5, -2.0, 0.0]);
}

#[test]
fn lengths_that_lie_under_right_checksums_are_found_without_taking_memory() {
    for count in [0, 2, 4, 1 << 40, u64::MAX] {
        let error = numbers_by_hand(count, |length| length).expect_err(&format!("count {count}"));
        assert!(error.to_string().contains("cannot be unpacked"), "{error}");
    }
    for wrong in [0, 1 << 40, u64::MAX] {
        let error = numbers_by_hand(3, |_| wrong).expect_err(&format!("length {wrong}"));
        assert!(error.to_string().contains("as its index says"), "{error}");
    }
}

#[test]
fn contents_that_break_a_promise_are_refused() {
    let refuse = |rows: &Rows, problem: &str| {
        let folder = folder();
        let (path, _) = written(&folder, rows);
        let message = read::<Rows>(&path).unwrap_err().to_string();
        assert!(message.contains(problem), "{problem:?} is not in {message:?}");
    };
    refuse(&Rows::from_rows(1, [vec![(0, f64::NAN)]]), "form factors that are not finite");

    let folder = folder();
    let path = folder.path().join("bad.eqx");
    let mut bad_part = part();
    bad_part.geometry.elements[1].face = FaceId(2);
    bad_part.write(&manifest()).write_to(&path).unwrap();
    let message = read::<BakedGeometry>(&path).unwrap_err().to_string();
    assert!(message.contains("element 1 in face 2 of 2"), "{message}");

    let mut bad_light = light();
    bad_light.local.factors.as_mut().unwrap().channels[1].rows = vec![1, 1];
    bad_light.write(&manifest()).write_to(&path).unwrap();
    let message = read::<BakedLight>(&path).unwrap_err().to_string();
    assert!(message.contains("a permutation that names a row twice"), "{message}");

    for (sizes, differences, problem) in [
        (vec![1u32, 1, 1], [0u32, 1], "groups do not fit"),
        (vec![1, 1], [0, 1], "groups do not fit"),
        (vec![2, 2], [0, 1], "groups do not fit"),
        (vec![u32::MAX, u32::MAX], [0, 1], "groups do not fit"),
        (vec![1, 2], [0, 5], "sender 5 of 5"),
    ] {
        #[derive(serde::Serialize)]
        struct Meta {
            senders: u32,
            precision: Precision,
        }
        let meta = Meta { senders: 5, precision: Precision::Full };
        let mut writer = Writer::new(Kind::Coupling, &manifest(), &meta);
        writer.array("group sizes", &sizes);
        writer.array("column differences", &differences);
        writer.array("form factors", &[0.5, 0.5]);
        writer.array::<f32>("single form factors", &[]);
        writer.write_to(&path).unwrap();
        let message = read::<Rows>(&path).unwrap_err().to_string();
        assert!(message.contains(problem), "{problem:?} is not in {message:?}");
    }
}

fn rows(senders: u32) -> impl Strategy<Value = Rows> {
    let row = proptest::collection::btree_map(0..senders, 0.0..1.0f64, 0..senders as usize);
    proptest::collection::vec(row, 0..20).prop_map(move |rows| {
        Rows::from_rows(senders as usize, rows.into_iter().map(|row| row.into_iter().collect()))
    })
}

proptest! {
    #[test]
    fn blocks_come_back(rows in rows(30)) {
        let folder = folder();
        let (path, _) = written(&folder, &rows);
        prop_assert_eq!(read::<Rows>(&path).unwrap(), rows);
    }

    #[test]
    fn arrays_come_back_to_the_last_bit(bits: Vec<u64>, small: Vec<u32>) {
        let folder = folder();
        let path = folder.path().join("arrays.eqx");
        let doubles: Vec<f64> = bits.iter().copied().map(f64::from_bits).collect();
        let mut writer = Writer::new(Kind::Coupling, &manifest(), &small.len());
        writer.array("doubles", &doubles);
        writer.array("small", &small);
        writer.write_to(&path).unwrap();

        let mut reader = Reader::open(&path, Kind::Coupling).unwrap();
        let read: Vec<f64> = reader.array("doubles").unwrap();
        prop_assert_eq!(read.into_iter().map(f64::to_bits).collect::<Vec<_>>(), bits);
        prop_assert_eq!(reader.meta::<usize>().unwrap(), small.len());
        prop_assert_eq!(reader.array::<u32>("small").unwrap(), small);
        prop_assert_eq!(reader.manifest(), &manifest());
        prop_assert!(reader.array::<f32>("doubles").is_err(), "f64 read as f32");
        prop_assert!(reader.array::<f64>("absent").is_err(), "an absent array was read");
    }
}

/// More than one chunk and more than one window of the decoder.
#[test]
fn long_arrays_come_back() {
    let folder = folder();
    let path = folder.path().join("long.eqx");
    let values: Vec<f64> = (0..3_000_001).map(|i| 1.0 / f64::from(i + 1)).collect();
    let mut writer = Writer::new(Kind::Coupling, &manifest(), &());
    writer.array("values", &values);
    writer.write_to(&path).unwrap();
    let read: Vec<f64> = Reader::open(&path, Kind::Coupling).unwrap().array("values").unwrap();
    assert!(read == values, "{} values came back of {}", read.len(), values.len());
}

#[test]
fn a_failed_write_leaves_no_litter() {
    let folder = folder();
    let taken = folder.path().join("taken.eqx");
    std::fs::create_dir(&taken).unwrap();
    let error = coupling().write(&manifest()).write_to(&taken).unwrap_err();
    assert!(error.to_string().contains("--cache DIR"), "{error}");
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1, "only what was there before");
}

#[test]
fn the_store_finds_what_it_keeps_and_nothing_else() {
    let folder = folder();
    let store = Store::open(folder.path().join("new/cache")).unwrap();
    let (manifest, other) = (manifest(), manifest().setting("tolerance", 0));
    assert!(matches!(store.load::<Rows>(&manifest.key()), Lookup::Missing));

    store.save(&manifest, &coupling()).unwrap();
    store.save(&manifest, &light()).unwrap();
    assert!(matches!(store.load::<Rows>(&manifest.key()), Lookup::Found(rows) if rows == coupling()));
    assert!(matches!(store.load::<BakedLight>(&manifest.key()), Lookup::Found(found) if found == light()));
    assert!(matches!(store.load::<BakedGeometry>(&manifest.key()), Lookup::Missing));

    let misplaced = store.path(Kind::Coupling, other.key());
    std::fs::copy(store.path(Kind::Coupling, manifest.key()), &misplaced).unwrap();
    let Lookup::Damaged(error) = store.load::<Rows>(&other.key()) else { panic!("another key's content") };
    assert!(error.to_string().contains(&manifest.key().to_string()), "{error}");
    store.save(&other, &coupling()).unwrap();
    assert!(matches!(store.load::<Rows>(&other.key()), Lookup::Found(_)), "saving replaces a damaged file");
}

#[test]
fn the_store_remembers_what_each_name_was_made_from() {
    let folder = folder();
    let store = Store::open(folder.path()).unwrap();
    assert_eq!(store.last_manifest("level.glb hall"), None);
    store.remember("level.glb hall", &Manifest::new()).unwrap();
    store.remember("level.glb hall", &manifest()).unwrap();
    assert_eq!(store.last_manifest("level.glb hall"), Some(manifest()));
    assert_eq!(store.last_manifest("level.glb cell"), None);
}

#[test]
fn a_cache_that_cannot_be_written_names_the_way_out() {
    let folder = folder();
    let file = folder.path().join("file");
    std::fs::write(&file, "").unwrap();
    let message = Store::open(file.join("cache")).unwrap_err().to_string();
    assert!(message.contains("file/cache") && message.contains("--cache DIR"), "{message}");
}

#[cfg(unix)]
#[test]
fn others_may_read_what_is_cached() {
    use std::os::unix::fs::PermissionsExt;
    let folder = folder();
    let ordinary = folder.path().join("ordinary");
    std::fs::write(&ordinary, "").unwrap();
    let (path, _) = written(&folder, &coupling());
    let mode = |path: &Path| path.metadata().unwrap().permissions().mode() & 0o777;
    assert_eq!(
        format!("{:o}", mode(&path)),
        format!("{:o}", mode(&ordinary)),
        "as any file under this umask"
    );
}

#[test]
fn the_reason_names_what_differs() {
    let old = manifest();
    let hall = |x: f64| Content::new().f64s(&[x]).digest();
    let new = |size: &str, x: f64| {
        Manifest::new().setting("kernel", 1).digest("geometry of hall", hall(x)).setting("element size", size)
    };
    let cases = [
        (manifest(), None),
        (manifest().setting("tolerance", 0), Some("tolerance is new, 0")),
        (manifest().digest("occluder pillar", hall(0.0)), Some("occluder pillar is new")),
        (new("0.25 m", 9.0), Some("geometry of hall changed")),
        (new("0.5 m", 9.0), Some("geometry of hall changed; element size was 0.25 m, is 0.5 m")),
        (
            Manifest::new().setting("kernel", 2),
            Some("kernel was 1, is 2; geometry of hall is gone; element size is gone"),
        ),
    ];
    for (new, reason) in cases {
        assert_eq!(new.difference(&old).as_deref(), reason);
    }
    let cut = |size: &str, x: f64| Manifest::new().digest("geometry", hall(x)).remark("element size", size);
    for (new, reason) in [
        (cut("0.5 m", 1.0), Some("geometry changed; element size was 0.25 m, is 0.5 m")),
        // The same geometry in a scene where it stands half as large.
        (cut("0.5 m", 0.0), None),
    ] {
        assert_eq!(new.difference(&cut("0.25 m", 0.0)).as_deref(), reason);
    }
    let (ab, ba) =
        (Manifest::new().setting("a", 1).setting("b", 2), Manifest::new().setting("b", 2).setting("a", 1));
    assert_eq!(ab.difference(&ba).as_deref(), Some("the order of the inputs changed"));
}

fn any_manifest() -> impl Strategy<Value = Manifest> {
    proptest::collection::vec((0..3, 0..2u8), 0..4).prop_map(|entries| {
        entries.into_iter().enumerate().fold(Manifest::new(), |manifest, (i, (kind, value))| {
            let label = ["kernel", "geometry", "size", "tolerance"][i];
            match kind {
                0 => manifest.digest(label, Content::new().bytes([value]).digest()),
                1 => manifest.setting(label, value),
                _ => manifest.remark(label, value),
            }
        })
    })
}

proptest! {
    #[test]
    fn there_is_a_reason_exactly_when_the_key_changes(old in any_manifest(), new in any_manifest()) {
        prop_assert_eq!(new.difference(&old).is_some(), new.key() != old.key(), "{:?} {:?}", old, new);
    }
}

#[test]
fn content_is_hashed_by_value_and_by_piece() {
    let floats = |values: &[f64]| Content::new().f64s(values).digest();
    assert_eq!(floats(&[-0.0, 1.0]), floats(&[0.0, 1.0]), "zero has one digest");
    assert_ne!(floats(&[1.0, 2.0]), floats(&[2.0, 1.0]));
    let pieces = |a: &str, b: &str| Content::new().bytes(a).bytes(b).digest();
    assert_ne!(pieces("ab", "c"), pieces("a", "bc"));
}
