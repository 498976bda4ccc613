//! The keys of everything that a run on a scene looks up in the cache, computed without any of it: they decide what in a
//! cache is still needed.
//!
//! There is a key for each part and for its light, and for each instance a key for the block that couples it with all
//! others, for that with the sky, for its own block with what stands inside it, and for its light with that. Not every
//! instance has all of these; a key without a file does no harm.

use crate::elements::repainted;
use crate::geometry::rounded_placement::RoundedPlacement;
use crate::gltf_import::import_scene;
use crate::oven::prepare::{Preparation, Prepared, prepare};
use crate::oven::{KERNEL_VERSION, geometry_manifest, light_manifest};
use crate::treecode::Resolution;
use equilux_formats::{Evicted, Instance, Key, Manifest, Result, Store};
use glam::DAffine3;
use std::collections::HashSet;
use std::path::PathBuf;

/// The block between an instance and all others, in manifests and in the cache.
pub const COUPLING: &str = "coupling";
/// An instance's own block with what stands inside it, in manifests and in the cache.
pub const CORRECTED: &str = "corrected self block";

/// Cells along each edge of the cube that a sky is cut into: 7.5° each.
pub const SKY_CELLS: usize = 12;

/// Drop from the cache whatever none of the scenes in `files` asks for. Fails and drops nothing if one of them cannot be
/// read, for then it is not known what it needs.
pub fn drop_unused(files: &[PathBuf], wanted: &Preparation, store: &Store) -> Result<Evicted> {
    let mut keys = HashSet::new();
    for file in files {
        keys.extend(keys_of(&prepare(&import_scene(file)?, wanted)?, wanted.resolution, store));
    }
    store.keep_only(&keys)
}

/// The keys under which `assemble` looks for the parts of a scene and for what couples them.
pub fn keys_of(scene: &Prepared, resolution: Resolution, store: &Store) -> HashSet<Key> {
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
        .map(|(&key, part)| BakedKey { key, senders: part.geometry.clusters.nodes() })
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

/// What manifests of blocks tell of a part.
#[derive(Debug, Clone, Copy)]
pub struct BakedKey {
    /// The key of its form factors.
    pub key: Key,
    /// The number of its senders, elements and clusters.
    pub senders: usize,
}

/// Another instance as one sees it: what a manifest of a block tells of it, so that of an older block it is known what it
/// was made among.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct RelativePlacement {
    /// Its part.
    pub part: Key,
    /// The number of its senders.
    pub senders: usize,
    /// Its placement as seen from the one.
    placement: RoundedPlacement,
}

impl RelativePlacement {
    /// A part at a place.
    pub fn new(part: BakedKey, placement: DAffine3) -> Self {
        Self { part: part.key, senders: part.senders, placement: placement.into() }
    }

    /// Where it stands, as seen from the one.
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

    /// Reads what is displayed.
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

/// Everything that a block of an instance depends on: its part, and every other instance, its part and where it stands as
/// seen from this one. `parts` tells of the parts' own form factors.
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
    for (number, seen) in placements_from(instances, parts, instance) {
        manifest = manifest.detail(format!("instance {number} ({})", instances[number].name), seen);
    }
    manifest
}

/// The same of the block between the sky's cells and an instance, and where the instance itself stands: the sky does not turn
/// with it.
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

/// Every other instance by its number, as one instance sees it.
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

/// The other instances that a manifest of a block tells of, by their numbers; none if it is not such a manifest.
pub fn placements_in(manifest: &Manifest) -> Option<Vec<(usize, RelativePlacement)>> {
    let read = |(label, text): (&str, &str)| {
        let number = label.strip_prefix("instance ")?.split(' ').next()?.parse().ok()?;
        Some((number, text.parse().ok()?))
    };
    manifest.details().map(read).collect()
}
