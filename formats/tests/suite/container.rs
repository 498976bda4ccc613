//! Files round-trip bit for bit, or reading fails with a reason.

use crate::samples::{coupling, folder, light, manifest, part, read, read_bytes, written};
use equilux_formats::baked::{BakedGeometry, BakedLight};
use equilux_formats::container::{FORMAT_VERSION, Kind, Reader, Writer};
use equilux_formats::fingerprint::Manifest;
use equilux_formats::rows::{CountedRow, Precision};
use equilux_formats::stored::Stored;
use equilux_formats::{Error, FaceId, Rows};
use proptest::prelude::*;
use std::collections::BTreeMap;
use std::fmt::Debug;
use std::path::Path;

/// Every change of one byte in the file of `value` is detected.
fn damage_is_found<T: Stored + Debug>(value: &T) {
    let folder = folder();
    let (path, bytes) = written(&folder, value);
    // As text, because −0 and 0 compare equal.
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
    for part in ["changed.eqx", "format version 11", "expected version 5", "bake it again"] {
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

/// A coupling file of one array, composed as FORMAT.md describes, without the library's code.
fn by_hand(count: u64, length: impl Fn(u64) -> u64) -> Vec<u8> {
    let numbers: Vec<u8> = [1.5f64, -2.0, 0.0].iter().flat_map(|number| number.to_le_bytes()).collect();
    let frame = zstd::encode_all(&numbers[..], 1).unwrap();
    let checksum = *blake3::hash(&frame).as_bytes();
    let entry = Entry { name: "numbers", number: "f64", count, length: length(frame.len() as u64), checksum };
    let index = Index { manifest: manifest(), arrays: vec![entry] };
    let messages = [rmp_serde::to_vec_named(&index).unwrap(), vec![0xC0]].concat();
    let header = [&b"EQUILUX\0\x05\0\0\0COUP"[..], &(messages.len() as u64).to_le_bytes()].concat();
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
        writer.array::<u16>("counted rays", &[]);
        writer.array::<u32>("rays of rows", &[]);
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

fn counted_rows(senders: u32) -> impl Strategy<Value = Rows> {
    let row = (proptest::collection::btree_map(0..senders, 1..100u16, 0..senders as usize), 0..500u32);
    let counted = |(counts, lost): (BTreeMap<u32, u16>, u32)| {
        let rays = lost + counts.values().map(|&count| u32::from(count)).sum::<u32>();
        CountedRow { counts: counts.into_iter().collect(), rays }
    };
    proptest::collection::vec(row, 0..20)
        .prop_map(move |rows| Rows::from_counts(senders as usize, rows.into_iter().map(counted)))
}

/// A row that says that more rays ended than it has is damage, not light.
#[test]
fn counted_rows_above_one_are_refused() {
    let rows = Rows::from_counts(3, [CountedRow { counts: vec![(0, 200), (2, 57)], rays: 256 }]);
    let folder = folder();
    let (path, _) = written(&folder, &rows);
    let message = read::<Rows>(&path).unwrap_err().to_string();
    assert!(message.contains("more rays ended than started"), "{message}");
}

proptest! {
    #[test]
    fn counted_blocks_come_back_and_can_be_parted(rows in counted_rows(30), column in 0usize..=30) {
        let folder = folder();
        let (path, _) = written(&folder, &rows);
        prop_assert_eq!(&read::<Rows>(&path).unwrap(), &rows);
        let [before, after] = rows.parted(column);
        for i in 0..rows.receivers() {
            let both: Vec<_> = before.row(i).chain(after.row(i).map(|(c, f)| (c + column, f))).collect();
            prop_assert_eq!(both, rows.row(i).collect::<Vec<_>>());
        }
    }

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
