//! The light of the last run of a scene, to start from instead of darkness. Any start leads to the same light; one near to
//! it takes fewer rounds.

use crate::placed_parts::PlacedParts;
use equilux_formats::{Lookup, Manifest, Result, Rgb, Solution, SolvedInstance, Store};
use std::path::Path;

/// The last light of every instance; dark where it is new or of another shape. None if nothing is known.
pub fn last_light(placed: &PlacedParts, store: &Store, file: &Path) -> Option<Vec<Vec<Rgb>>> {
    let Lookup::Found(last) = store.load::<Solution>(&manifest(file).key()) else { return None };
    let of = |k: usize| {
        let dark = || vec![Rgb::BLACK; placed.world.elements_of(k).len()];
        let known = last.of(&placed.instances[k].name, placed.part_of(k).key);
        known.cloned().unwrap_or_else(dark)
    };
    Some((0..placed.instances.len()).map(of).collect())
}

/// Keep the light for the next run.
pub fn keep(placed: &PlacedParts, store: &Store, file: &Path, radiosity: &[Rgb]) -> Result<()> {
    let instance = |k: usize| SolvedInstance {
        name: placed.instances[k].name.clone(),
        part: placed.part_of(k).key,
        elements: placed.world.elements_of(k).len(),
    };
    let instances = (0..placed.instances.len()).map(instance).collect();
    store.save(&manifest(file), &Solution { instances, radiosity: placed.split(radiosity) })
}

/// There is one last light a scene file.
fn manifest(file: &Path) -> Manifest {
    Manifest::new().setting("last light of", file.display())
}
