//! Cache lookups by key and by name.

use crate::samples::{coupling, folder, light, manifest};
use equilux_formats::baked::{BakedGeometry, BakedLight};
use equilux_formats::container::Kind;
use equilux_formats::fingerprint::Manifest;
use equilux_formats::store::Lookup;
use equilux_formats::{Rows, Store};

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
