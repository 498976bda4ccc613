//! A scene's light in memory, in equilibrium, to be asked for more than the outputs tell.

use equilux_assemble::classic::whole;
use equilux_assemble::coupling::{Coupled, Coupler};
use equilux_assemble::exchange::{Goal, Method, Outcome, exchange, nodes};
use equilux_assemble::placed::Placed;
use equilux_bake::gltf_import::import_scene;
use equilux_bake::monitor::Monitor;
use equilux_bake::oven::Oven;
use equilux_bake::prepare::{Preparation, prepare};
use equilux_formats::{Optics, Store};
use std::path::Path;

/// The parts of a scene in their places, and their light.
pub struct Lit {
    /// The parts.
    pub placed: Placed,
    /// Reflectance and emission of all elements.
    pub optics: Optics,
    /// The light.
    pub outcome: Outcome,
}

/// The light of a scene down to an error of 1e-6; what is baked goes to a folder that is gone afterwards.
pub fn lit(scene: &Path, wanted: &Preparation) -> Lit {
    let folder = tempfile::tempdir().expect("a folder");
    let (placed, coupled) = coupled(scene, folder.path(), wanted);
    let each: Vec<Optics> = (0..placed.instances.len()).map(|k| placed.optics_of(k)).collect();
    let goal = Goal { error: 1e-6, rounds: usize::MAX };
    let outcome = exchange(&nodes(&placed, &coupled, &each), Method::Auto, goal, None, &Monitor::default());
    Lit { optics: whole(&each), placed, outcome }
}

/// The parts of a scene in their places, and what couples them; what is baked goes to the folder `cache`.
pub fn coupled(scene: &Path, cache: &Path, wanted: &Preparation) -> (Placed, Vec<Coupled>) {
    let (store, monitor) = (Store::open(cache).expect("a cache"), Monitor::default());
    let prepared = prepare(&import_scene(scene).expect("a scene"), wanted).expect("elements");
    let resolution = wanted.resolution;
    let oven = Oven { store: &store, file: scene, resolution, monitor: &monitor };
    let parts = prepared.parts.iter().map(|part| oven.bake(part).expect("baked").expect("not stopped"));
    let placed = Placed::new(parts.collect(), prepared.instances);
    let coupler = Coupler { placed: &placed, store: &store, file: scene, resolution, monitor: &monitor };
    let couple = |k: usize| coupler.couple(k).expect("coupled").expect("not stopped");
    let coupled = (0..placed.instances.len()).map(couple).collect();
    (placed, coupled)
}
