//! Radiosity of the last run of a scene, used as the start of the exchange instead of zero. Every start leads to the
//! same solution; a close one needs fewer rounds.

use crate::placed_parts::PlacedParts;
use equilux_formats::fingerprint::Manifest;
use equilux_formats::solution::SolvedInstance;
use equilux_formats::store::Lookup;
use equilux_formats::{Result, Rgb, Solution, Store};
use std::path::Path;

/// The last radiosity of every instance, W/m²; zero where the instance is new or its part has changed. None if no
/// radiosity is stored.
pub fn last_light(placed: &PlacedParts, store: &Store, file: &Path) -> Option<Vec<Vec<Rgb>>> {
    let Lookup::Found(last) = store.load::<Solution>(&manifest(file).key()) else { return None };
    let of = |k: usize| {
        let dark = || vec![Rgb::BLACK; placed.world.elements_of(k).len()];
        let known = last.of(&placed.instances[k].name, placed.part_of(k).key);
        known.cloned().unwrap_or_else(dark)
    };
    Some((0..placed.instances.len()).map(of).collect())
}

/// Store the radiosity for the next run. Fails if the cache cannot be written.
pub fn keep(placed: &PlacedParts, store: &Store, file: &Path, radiosity: &[Rgb]) -> Result<()> {
    let instance = |k: usize| SolvedInstance {
        name: placed.instances[k].name.clone(),
        part: placed.part_of(k).key,
        elements: placed.world.elements_of(k).len(),
    };
    let instances = (0..placed.instances.len()).map(instance).collect();
    store.save(&manifest(file), &Solution { instances, radiosity: placed.split(radiosity) })
}

/// Each scene file has one stored radiosity.
fn manifest(file: &Path) -> Manifest {
    Manifest::new().setting("last light of", file.display())
}
