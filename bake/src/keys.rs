//! The keys of everything that a run on a scene asks the cache for, without computing any of it: so it can be told what in a
//! cache is needed.
//!
//! In go prepared parts in their places; out come keys: of each part and its light, and for each instance of the block that
//! couples it with all others, of its own block with what stands inside it, and of its light with that. Not every instance
//! has all of these: whether something stands inside one does not matter here, as a key under which nothing lies
//! harms nobody.

use crate::elements::repainted;
use crate::gltf_import::import_scene;
use crate::oven::{KERNEL_VERSION, geometry_manifest, light_manifest};
use crate::prepare::{Preparation, Prepared, prepare};
use crate::treecode::Resolution;
use equilux_formats::{Content, Instance, Key, Manifest, Result, Store, Swept};
use std::collections::HashSet;
use std::path::PathBuf;

/// The block between an instance and all others, in manifests and in the cache.
pub const COUPLING: &str = "coupling";
/// An instance's own block with what stands inside it, in manifests and in the cache.
pub const CORRECTED: &str = "corrected self block";

/// Drop from the cache whatever none of the scenes in `files` asks for. Fails and drops nothing if one of them cannot be
/// read, for then it is not known what it needs.
pub fn drop_unused(files: &[PathBuf], wanted: &Preparation, store: &Store) -> Result<Swept> {
    let mut keys = HashSet::new();
    for file in files {
        keys.extend(keys_of(&prepare(&import_scene(file)?, wanted)?, wanted.resolution));
    }
    store.keep_only(&keys)
}

/// The keys under which `assemble` looks for the parts of a scene and for what couples them.
pub fn keys_of(scene: &Prepared, resolution: Resolution) -> HashSet<Key> {
    let part_keys: Vec<Key> =
        scene.parts.iter().map(|part| geometry_manifest(part, resolution).key()).collect();
    let mut keys = HashSet::new();
    for (part, &key) in scene.parts.iter().zip(&part_keys) {
        let light = light_manifest(key.into(), &part.optics, part.solver);
        keys.extend([key, light.key()]);
    }
    for number in 0..scene.instances.len() {
        let key = |what| placed_manifest(&scene.instances, &part_keys, resolution, number, what).key();
        let part = &scene.parts[scene.instances[number].part.index()];
        let optics = repainted(&part.geometry, &part.optics, &scene.instances[number].repainted);
        let own = part_keys[scene.instances[number].part.index()];
        let light = |block: Key| light_manifest(block.into(), &optics, part.solver).key();
        keys.extend([key(COUPLING), key(CORRECTED), light(key(CORRECTED)), light(own)]);
    }
    keys
}

/// Everything that a block of an instance depends on: its part, and every other instance, its part and where it stands as
/// seen from this one. `part_keys` are those of the parts' own form factors.
pub fn placed_manifest(
    instances: &[Instance],
    part_keys: &[Key],
    resolution: Resolution,
    instance: usize,
    what: &str,
) -> Manifest {
    let key_of = |instance: &Instance| part_keys[instance.part.index()];
    let inverse = instances[instance].placement.inverse();
    let mut manifest = Manifest::new()
        .setting("block", what)
        .setting("kernel", KERNEL_VERSION)
        .setting("resolution", resolution)
        .digest("the part", key_of(&instances[instance]));
    for (number, other) in instances.iter().enumerate().filter(|&(n, _)| n != instance) {
        let relative = inverse * other.placement;
        let seen = Content::new().bytes(key_of(other).to_string()).f64s(&relative.to_cols_array());
        manifest = manifest.digest(format!("instance {number} ({})", other.name), seen.digest());
    }
    manifest
}
