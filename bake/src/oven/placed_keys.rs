//! What the keys of blocks are made of: the instances of a scene with their parts and placements.

use super::KERNEL_VERSION;
use crate::geometry::rounded_placement::RoundedPlacement;
use crate::treecode::Resolution;
use equilux_formats::fingerprint::{Key, Manifest};
use equilux_formats::{Instance, PartId, TexelChoice};
use glam::DAffine3;
use std::collections::HashMap;
use std::path::Path;
use std::str::Split;

/// The block between an instance and all others, in manifests and in the cache.
pub const COUPLING: &str = "coupling";
/// The self block of an instance, corrected for occluders inside it, in manifests and in the cache.
pub const CORRECTED: &str = "corrected self block";

/// Cells along each edge of the cube map of a sky: 7.5° each.
pub const SKY_CELLS: usize = 12;

/// The form factors of an instance to emitting surfaces, in manifests and in the cache.
pub const SOURCES: &str = "light of sources";
/// The form factors of an instance to the places that sources light brightly, in manifests and in the cache.
pub const SECONDARY_SOURCES: &str = "light of secondary sources";

/// The rays of texels of lightmaps, in manifests and in the cache.
pub const TEXEL_RAYS: &str = "rays of texels at knots";
/// How charts are divided into texels that have rays, in manifests and in the cache.
pub const TEXEL_LAYOUT: &str = "knots of rays of texels";
/// The form factors of texels to lights with sharp shadows, in manifests and in the cache.
pub const TEXEL_LIGHT: &str = "light of texels";
/// The form factors of places that rays of texels see, in manifests and in the cache.
pub const PLACE_LIGHT: &str = "light of places near texels";

/// The name of such a block of texels in the cache: an instance has as many of each kind as `number` goes up to.
pub fn texel_block(what: &str, number: usize) -> String {
    format!("{what} {number}")
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
        let (BakedKey { key, senders }, mut words) = part_in(text)?;
        let exponent = words.next().ok_or(())?.parse().map_err(|_| ())?;
        let steps = twelve(words, |word| word.parse().ok())?;
        Ok(Self { part: key, senders, placement: RoundedPlacement { steps, exponent } })
    }
}

/// The instances of a scene and their baked parts, as the keys of blocks know them.
#[derive(Debug, Clone)]
pub struct PlacedKeys {
    /// The instances.
    pub instances: Vec<Instance>,
    /// The baked parts, by number.
    pub parts: Vec<BakedKey>,
    /// For each instance the number of those before it that have its name.
    twins: Vec<usize>,
    resolution: Resolution,
    /// All of these, if rows are counted rays. A ray may meet any instance, so every block depends on all; and what it meets is
    /// one or the other to the bit, so that placements count to the bit.
    pub scene: Option<Manifest>,
}

impl PlacedKeys {
    /// These instances of these parts.
    pub fn new(instances: Vec<Instance>, parts: Vec<BakedKey>, resolution: Resolution) -> Self {
        let scene = resolution.rays.map(|_| {
            let settings = Manifest::new()
                .setting("scene", "placed parts")
                .setting("kernel", KERNEL_VERSION)
                .setting("resolution", resolution);
            let all = instances.iter().enumerate();
            all.fold(settings, |manifest, (number, instance)| {
                let placed = ExactPlacement::new(parts[instance.part.index()], instance.placement);
                manifest.detail(format!("instance {number} ({})", instance.name), placed)
            })
        });
        Self { twins: twins(&instances), instances, parts, resolution, scene }
    }

    /// The scene that a manifest like [`PlacedKeys::scene`] describes; none if it is of another kind, or was made with other
    /// settings.
    pub fn earlier(&self, manifest: &Manifest) -> Option<Self> {
        if !self.scene.as_ref()?.is_alike(manifest) {
            return None;
        }
        let (mut instances, mut parts) = (vec![], Vec::<BakedKey>::new());
        for (label, text) in manifest.details() {
            let name = label.split_once(" (")?.1.strip_suffix(')')?.to_owned();
            let ExactPlacement { part, placement } = text.parse().ok()?;
            let known = parts.iter().position(|known| known.key == part.key);
            let id = PartId::from_index(known.unwrap_or(parts.len()));
            if known.is_none() {
                parts.push(part);
            }
            instances.push(Instance {
                name,
                part: id,
                placement,
                emission_scale: 1.0,
                repainted: vec![],
                texels: TexelChoice::default(),
            });
        }
        let (twins, scene) = (twins(&instances), Some(manifest.clone()));
        Some(Self { instances, parts, twins, resolution: self.resolution, scene })
    }

    /// The inputs of a block of an instance: its part, and the part and placement of every other instance, relative to the
    /// instance where rows are exact. `what`: the kind of block.
    pub fn manifest(&self, instance: usize, what: &str) -> Manifest {
        let manifest = Manifest::new()
            .setting("block", what)
            .setting("kernel", KERNEL_VERSION)
            .setting("resolution", self.resolution)
            .digest("the part", self.part_of(instance).key);
        if let Some(scene) = &self.scene {
            return manifest.digest("the scene", scene.key()).setting("instance", instance);
        }
        self.placements_from(instance).fold(manifest, |manifest, (number, seen)| {
            manifest.detail(format!("instance {number} ({})", self.instances[number].name), seen)
        })
    }

    /// The inputs of the block between the sky's cells and an instance: those of [`PlacedKeys::manifest`] and the instance's own
    /// placement, because the sky does not turn with it.
    pub fn sky_manifest(&self, instance: usize) -> Manifest {
        let own = RelativePlacement::new(self.part_of(instance), self.instances[instance].placement);
        self.manifest(instance, "sky").setting("sky's cells", SKY_CELLS).setting("placement", own)
    }

    /// The name of a block of an instance in the cache, for a scene that is read from `file`.
    pub fn name(&self, file: &Path, instance: usize, what: &str) -> String {
        let (name, twins) = (&self.instances[instance].name, self.twins[instance]);
        format!("{what} of {name} #{twins} in {}", file.display())
    }

    /// Number and relative placement of every other instance.
    pub fn placements_from(&self, instance: usize) -> impl Iterator<Item = (usize, RelativePlacement)> {
        let inverse = self.instances[instance].placement.inverse();
        let others = self.instances.iter().enumerate().filter(move |&(n, _)| n != instance);
        others.map(move |(n, other)| (n, RelativePlacement::new(self.part_of(n), inverse * other.placement)))
    }

    /// The baked part of an instance.
    pub fn part_of(&self, instance: usize) -> BakedKey {
        self.parts[self.instances[instance].part.index()]
    }
}

/// For each instance the number of those before it that have its name.
fn twins(instances: &[Instance]) -> Vec<usize> {
    let mut known: HashMap<&str, usize> = HashMap::new();
    let mut number = |name| {
        let count = known.entry(name).or_default();
        *count += 1;
        *count - 1
    };
    instances.iter().map(|instance| number(instance.name.as_str())).collect()
}

/// A part and its placement in the scene, to the bit.
struct ExactPlacement {
    part: BakedKey,
    placement: DAffine3,
}

impl ExactPlacement {
    fn new(part: BakedKey, placement: DAffine3) -> Self {
        Self { part, placement }
    }
}

impl std::fmt::Display for ExactPlacement {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{} {}", self.part.key, self.part.senders)?;
        let numbers = self.placement.to_cols_array();
        // −0 and 0 place alike.
        numbers.iter().try_for_each(|number| write!(f, " {:x}", (number + 0.0).to_bits()))
    }
}

impl std::str::FromStr for ExactPlacement {
    type Err = ();

    /// Parses the displayed form.
    fn from_str(text: &str) -> std::result::Result<Self, ()> {
        let (part, words) = part_in(text)?;
        let numbers = twelve(words, |word| u64::from_str_radix(word, 16).ok().map(f64::from_bits))?;
        Ok(Self { part, placement: DAffine3::from_cols_array(&numbers) })
    }
}

/// The part that a displayed placement begins with, and the words after it.
fn part_in(text: &str) -> Result<(BakedKey, Split<'_, char>), ()> {
    let mut words = text.split(' ');
    let key = words.next().ok_or(())?.parse()?;
    let senders = words.next().ok_or(())?.parse().map_err(|_| ())?;
    Ok((BakedKey { key, senders }, words))
}

/// The numbers of a placement.
fn twelve<T>(words: Split<char>, parse: impl Fn(&str) -> Option<T>) -> Result<[T; 12], ()> {
    let numbers: Option<Vec<T>> = words.map(parse).collect();
    numbers.and_then(|numbers| numbers.try_into().ok()).ok_or(())
}

/// Numbers and relative placements of the other instances that a block's manifest records; none if it is not such a manifest.
pub fn placements_in(manifest: &Manifest) -> Option<Vec<(usize, RelativePlacement)>> {
    let read = |(label, text): (&str, &str)| {
        let number = label.strip_prefix("instance ")?.split(' ').next()?.parse().ok()?;
        Some((number, text.parse().ok()?))
    };
    manifest.details().map(read).collect()
}
