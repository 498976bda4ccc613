//! The keys of everything that a run on a scene looks up in the cache, computed without the results themselves. Cache
//! eviction keeps the files of these keys.
//!
//! There is a key for each part and for its light, and for each instance a key for the block that couples it with all
//! others, for the one with the sky, for its self block corrected for occluders inside it, and for its light with that
//! block, and those of the texels of its last lightmap. Not every instance has all of these; keys without a file are harmless.

use crate::elements::repainted;
use crate::gltf_import::import_scene;
use crate::oven::placed_keys::{
    BakedKey, CORRECTED, COUPLING, PLACE_LIGHT, PlacedKeys, SECONDARY_SOURCES, SOURCES, TEXEL_LAYOUT,
    TEXEL_LIGHT, TEXEL_RAYS, texel_block,
};
use crate::oven::prepare::{Preparation, Prepared, prepare};
use crate::oven::{geometry_manifest, light_manifest};
use equilux_formats::fingerprint::{Key, Manifest};
use equilux_formats::store::Evicted;
use equilux_formats::{Result, Store};
use std::collections::HashSet;
use std::path::{Path, PathBuf};

/// Removes from the cache what none of the scenes in `files` uses. Fails and removes nothing if one of them cannot be read.
pub fn drop_unused(files: &[PathBuf], wanted: &Preparation, store: &Store) -> Result<Evicted> {
    let mut keys = HashSet::new();
    for file in files {
        keys.extend(keys_of(&prepare(&import_scene(file)?, wanted)?, store, file));
    }
    store.keep_only(&keys)
}

/// The keys that `assemble` looks up for the parts of a scene, read from `file`, and their couplings.
pub fn keys_of(scene: &Prepared, store: &Store, file: &Path) -> HashSet<Key> {
    let resolution = scene.resolution;
    let part_keys: Vec<Key> =
        scene.parts.iter().map(|part| geometry_manifest(part, resolution).key()).collect();
    let mut keys = HashSet::new();
    for (part, &key) in scene.parts.iter().zip(&part_keys) {
        let light = light_manifest(key.into(), &part.optics, part.solver);
        keys.extend([key, light.key()]);
    }
    let parts = scene.parts.iter().zip(&part_keys);
    let parts =
        parts.map(|(part, &key)| BakedKey { key, senders: part.geometry.unknowns().nodes() }).collect();
    let placed = PlacedKeys::new(scene.instances.clone(), parts, resolution);
    keys.extend(placed.scene.as_ref().map(Manifest::key));
    for number in 0..scene.instances.len() {
        let key = |what| placed.manifest(number, what).key();
        let part = &scene.parts[scene.instances[number].part.index()];
        let optics = repainted(&part.geometry, &part.optics, &part.tints, &scene.instances[number].repainted);
        let own = part_keys[scene.instances[number].part.index()];
        let light = |block: Key| light_manifest(block.into(), &optics, part.solver).key();
        let [coupling, corrected] = [key(COUPLING), key(CORRECTED)];
        keys.insert(placed.sky_manifest(number).key());
        let target = store.target(&corrected);
        keys.extend([coupling, store.target(&coupling), corrected, target, light(target), light(own)]);
        // Which places are sources is known after the rows only, and texels after a lightmap was asked for: what the last run
        // used is kept, if the scene is still the same.
        let last = |what, name: &str| {
            let last = store.last_manifest(&placed.name(file, number, name))?;
            Some((last.extends(&placed.manifest(number, what)), last.key()))
        };
        let keep = |(same, key): (bool, Key)| same.then_some(key);
        keys.extend([SOURCES, SECONDARY_SOURCES].into_iter().filter_map(|what| keep(last(what, what)?)));
        for what in [TEXEL_RAYS, TEXEL_LAYOUT, TEXEL_LIGHT, PLACE_LIGHT] {
            let blocks = (0..).map_while(|block| last(what, &texel_block(what, block)));
            keys.extend(blocks.filter_map(keep));
        }
    }
    keys
}
