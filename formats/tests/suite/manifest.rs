//! Keys change exactly when the manifest gives a reason.

use crate::samples::manifest;
use equilux_formats::fingerprint::{Content, Manifest};
use proptest::prelude::*;

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
