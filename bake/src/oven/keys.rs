//! The keys of everything that a run on a scene looks up in the cache, computed without the results themselves. Cache
//! eviction keeps the files of these keys.
//!
//! There is a key for each part and for its light, and for each instance a key for the block that couples it with all
//! others, for the one with the sky, for its self block corrected for occluders inside it, and for its light with that
//! block. Not every instance has all of these; keys without a file are harmless.

use crate::elements::repainted;
use crate::geometry::rounded_placement::RoundedPlacement;
use crate::gltf_import::import_scene;
use crate::oven::prepare::{Preparation, Prepared, prepare};
use crate::oven::{KERNEL_VERSION, geometry_manifest, light_manifest};
use crate::treecode::Resolution;
use equilux_formats::fingerprint::{Key, Manifest};
use equilux_formats::store::Evicted;
use equilux_formats::{Instance, Result, Store};
use glam::DAffine3;
use std::collections::HashSet;
use std::path::PathBuf;

/// The block between an instance and all others, in manifests and in the cache.
pub const COUPLING: &str = "coupling";
/// The self block of an instance, corrected for occluders inside it, in manifests and in the cache.
pub const CORRECTED: &str = "corrected self block";

/// Cells along each edge of the cube map of a sky: 7.5° each.
pub const SKY_CELLS: usize = 12;

/// Removes from the cache what none of the scenes in `files` uses. Fails and removes nothing if one of them cannot be read.
pub fn drop_unused(files: &[PathBuf], wanted: &Preparation, store: &Store) -> Result<Evicted> {
    let mut keys = HashSet::new();
    for file in files {
        keys.extend(keys_of(&prepare(&import_scene(file)?, wanted)?, store));
    }
    store.keep_only(&keys)
}

/// The keys that `assemble` looks up for the parts of a scene and their couplings.
pub fn keys_of(scene: &Prepared, store: &Store) -> HashSet<Key> {
    let resolution = scene.resolution;
    let part_keys: Vec<Key> =
        scene.parts.iter().map(|part| geometry_manifest(part, resolution).key()).collect();
    let mut keys = HashSet::new();
    for (part, &key) in scene.parts.iter().zip(&part_keys) {
        let light = light_manifest(key.into(), &part.optics, part.solver);
        keys.extend([key, light.key()]);
    }
    let parts: Vec<BakedKey> = part_keys
        .iter()
        .zip(&scene.parts)
        .map(|(&key, part)| BakedKey { key, senders: part.geometry.unknowns().nodes() })
        .collect();
    for number in 0..scene.instances.len() {
        let key = |what| placed_manifest(&scene.instances, &parts, resolution, number, what).key();
        let part = &scene.parts[scene.instances[number].part.index()];
        let optics = repainted(&part.geometry, &part.optics, &part.tints, &scene.instances[number].repainted);
        let own = part_keys[scene.instances[number].part.index()];
        let light = |block: Key| light_manifest(block.into(), &optics, part.solver).key();
        let [coupling, corrected] = [key(COUPLING), key(CORRECTED)];
        keys.insert(sky_manifest(&scene.instances, &parts, resolution, number).key());
        let target = store.target(&corrected);
        keys.extend([coupling, store.target(&coupling), corrected, target, light(target), light(own)]);
    }
    keys
}

/// The fields of a part that a block's manifest records.
#[derive(Debug, Clone, Copy)]
pub struct BakedKey {
    /// The key of its form factors.
    pub key: Key,
    /// The number of its senders, elements and clusters.
    pub senders: usize,
}

/// A part and its placement relative to an instance. A block's manifest records one for every other instance, so that
/// an older block can be compared with the present scene.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct RelativePlacement {
    /// Its part.
    pub part: Key,
    /// The number of its senders.
    pub senders: usize,
    /// Its placement in the coordinates of that instance.
    placement: RoundedPlacement,
}

impl RelativePlacement {
    /// A part with its relative placement.
    pub fn new(part: BakedKey, placement: DAffine3) -> Self {
        Self { part: part.key, senders: part.senders, placement: placement.into() }
    }

    /// Its placement in the coordinates of that instance.
    pub fn placement(&self) -> DAffine3 {
        self.placement.into()
    }
}

impl std::fmt::Display for RelativePlacement {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{} {} {}", self.part, self.senders, self.placement.exponent)?;
        self.placement.steps.iter().try_for_each(|step| write!(f, " {step}"))
    }
}

impl std::str::FromStr for RelativePlacement {
    type Err = ();

    /// Parses the displayed form.
    fn from_str(text: &str) -> std::result::Result<Self, ()> {
        let mut words = text.split(' ');
        let mut next = || words.next().ok_or(());
        let part = next()?.parse()?;
        let senders = next()?.parse().map_err(|_| ())?;
        let exponent = next()?.parse().map_err(|_| ())?;
        let mut steps = [0; 12];
        for step in &mut steps {
            *step = next()?.parse().map_err(|_| ())?;
        }
        Ok(Self { part, senders, placement: RoundedPlacement { steps, exponent } })
    }
}

/// The inputs of a block of an instance: its part, and the part and relative placement of every other instance. `parts`
/// are the baked parts by number, and `what` is the kind of block.
pub fn placed_manifest(
    instances: &[Instance],
    parts: &[BakedKey],
    resolution: Resolution,
    instance: usize,
    what: &str,
) -> Manifest {
    let mut manifest = Manifest::new()
        .setting("block", what)
        .setting("kernel", KERNEL_VERSION)
        .setting("resolution", resolution)
        .digest("the part", parts[instances[instance].part.index()].key);
    if resolution.rays.is_some() {
        // Rays that leave the scene meet cells of the sky, which does not turn with the instance.
        let turn = DAffine3::from_mat3(instances[instance].placement.matrix3);
        let part = parts[instances[instance].part.index()];
        manifest = manifest.setting("orientation", RelativePlacement::new(part, turn));
    }
    for (number, seen) in placements_from(instances, parts, instance) {
        manifest = manifest.detail(format!("instance {number} ({})", instances[number].name), seen);
    }
    manifest
}

/// The inputs of the block between the sky's cells and an instance: those of [`placed_manifest`] and the instance's own
/// placement, because the sky does not turn with it.
pub fn sky_manifest(
    instances: &[Instance],
    parts: &[BakedKey],
    resolution: Resolution,
    instance: usize,
) -> Manifest {
    let own = &instances[instance];
    placed_manifest(instances, parts, resolution, instance, "sky")
        .setting("sky's cells", SKY_CELLS)
        .setting("placement", RelativePlacement::new(parts[own.part.index()], own.placement))
}

/// Number and relative placement of every other instance.
pub fn placements_from<'a>(
    instances: &'a [Instance],
    parts: &'a [BakedKey],
    instance: usize,
) -> impl Iterator<Item = (usize, RelativePlacement)> + 'a {
    let inverse = instances[instance].placement.inverse();
    let others = instances.iter().enumerate().filter(move |&(n, _)| n != instance);
    others.map(move |(n, other)| {
        (n, RelativePlacement::new(parts[other.part.index()], inverse * other.placement))
    })
}

/// Numbers and relative placements of the other instances that a block's manifest records; none if it is not such a manifest.
pub fn placements_in(manifest: &Manifest) -> Option<Vec<(usize, RelativePlacement)>> {
    let read = |(label, text): (&str, &str)| {
        let number = label.strip_prefix("instance ")?.split(' ').next()?.parse().ok()?;
        Some((number, text.parse().ok()?))
    };
    manifest.details().map(read).collect()
}
