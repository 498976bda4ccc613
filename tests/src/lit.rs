//! A scene's equilibrium in memory, for tests that need more than the outputs contain.

use crate::averages::mean;
use equilux_assemble::equation::coupling::{Coupled, Coupler};
use equilux_assemble::equation::optics::joined;
use equilux_assemble::equation::systems;
use equilux_assemble::exchange::exchange;
use equilux_assemble::exchange::listener::Unobserved;
use equilux_assemble::exchange::outcome::Outcome;
use equilux_assemble::exchange::settings::{Goal, Method};
use equilux_assemble::gather::Gather;
use equilux_assemble::gather::outside::lights;
use equilux_assemble::gather::sky::Radiances;
use equilux_assemble::lightmap::Lightmap;
use equilux_assemble::lightmap::atlas::Atlas;
use equilux_assemble::lightmap::light::TexelLight;
use equilux_assemble::placed_parts::PlacedParts;
use equilux_bake::gltf_import::import_scene;
use equilux_bake::monitor::Monitor;
use equilux_bake::oven::Oven;
use equilux_bake::oven::prepare::{Preparation, prepare};
use equilux_bake::treecode::EXACT;
use equilux_formats::{Optics, Rgb, Scene, Store};
use std::path::Path;

/// The placed parts of a scene, and their light.
#[derive(Debug)]
pub struct Lit {
    /// The parts.
    pub placed: PlacedParts,
    /// Reflectance and emission of all elements.
    pub optics: Optics,
    /// The light.
    pub outcome: Outcome,
}

/// The light of a scene, to an error of 1e-6, with a temporary cache.
pub fn lit(scene: &Path, wanted: &Preparation) -> Lit {
    lit_scene(&import_scene(scene).expect("a scene"), wanted)
}

/// The light of a scene in memory.
pub fn lit_scene(scene: &Scene, wanted: &Preparation) -> Lit {
    let folder = tempfile::tempdir().expect("a folder");
    let (placed, coupled) = coupled_scene(scene, folder.path(), wanted);
    let each: Vec<Optics> = (0..placed.instances.len()).map(|k| placed.optics_of(k)).collect();
    let goal = Goal { error: 1e-6, rounds: usize::MAX };
    let outcome = exchange(
        &systems(&placed, &coupled, &each),
        Method::Auto,
        goal,
        None,
        &Monitor::default(),
        &Unobserved,
    );
    Lit { optics: joined(&each), placed, outcome }
}

/// The lightmap of a scene in this light and that of the sky, W/(m² sr), from all around.
pub fn lightmap<'a>(scene: &'a Scene, atlas: &'a Atlas, lit: &Lit, sky: f64) -> Lightmap<'a> {
    let radiances = Radiances::Uniform(Rgb([sky; 3]));
    let lights = lights(&[], None, Some(&radiances), &lit.placed.world);
    let gather = Gather::new(&lit.placed, &lit.optics.emission, &lit.outcome.radiosity, &lights, EXACT);
    let light = TexelLight::new(&gather, mean(&lit.outcome.irradiance));
    Lightmap::new(scene, atlas, |texels| light.irradiance(texels), &Monitor::default()).expect("not stopped")
}

/// The placed parts of a scene, and their couplings, with the cache folder `cache`.
pub fn coupled(scene: &Path, cache: &Path, wanted: &Preparation) -> (PlacedParts, Vec<Coupled>) {
    coupled_scene(&import_scene(scene).expect("a scene"), cache, wanted)
}

fn coupled_scene(scene: &Scene, cache: &Path, wanted: &Preparation) -> (PlacedParts, Vec<Coupled>) {
    let (store, monitor) = (Store::open(cache).expect("a cache"), Monitor::default());
    let prepared = prepare(scene, wanted).expect("elements");
    let (resolution, file) = (wanted.resolution, scene.file.as_path());
    let oven = Oven { store: &store, file, resolution, monitor: &monitor };
    let parts = prepared.parts.iter().map(|part| oven.bake(part).expect("baked"));
    let placed = PlacedParts::new(parts.collect(), prepared.instances);
    let coupler = Coupler::new(&oven, &placed);
    let couple = |k: usize| coupler.couple(k).expect("coupled");
    let coupled = (0..placed.instances.len()).map(couple).collect();
    (placed, coupled)
}
