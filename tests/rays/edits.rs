//! After an edit the rows of counted rays are those from nothing, in whole numbers, and only what the edit touches is traced.

use equilux_assemble::equation::Equation;
use equilux_assemble::equation::environment::Environment;
use equilux_assemble::exchange::listener::Unobserved;
use equilux_bake::elements::ElementSize;
use equilux_bake::gltf_import::import_scene;
use equilux_bake::monitor::Monitor;
use equilux_bake::oven::Oven;
use equilux_bake::oven::prepare::{Preparation, RowMethod, prepare};
use equilux_formats::Store;
use equilux_tests::edited::{Dice, Thing, edit, scene};
use equilux_tests::workshop::Workshop;
use std::path::Path;

/// The equation of a scene with blocks from this cache.
fn equation(file: &Path, cache: &Path) -> Equation {
    let wanted = Preparation {
        element_size: Some(ElementSize::Metres(0.5)),
        rows: RowMethod::Rays,
        rays: 64,
        ..Preparation::default()
    };
    let (store, monitor) = (Store::open(cache).expect("a cache"), Monitor::default());
    let scene = import_scene(file).expect("a scene");
    let prepared = prepare(&scene, &wanted).expect("elements");
    let oven = Oven { store: &store, file, resolution: prepared.resolution, monitor: &monitor };
    let environment = Environment::read(None, None).expect("no sky");
    Equation::new(&oven, &scene, prepared, &environment, &Unobserved).expect("blocks")
}

/// The rays traced for the couplings of a scene.
fn traced(equation: &Equation) -> usize {
    equation.coupled.iter().map(|coupled| coupled.rays).sum()
}

#[test]
fn after_two_hundred_edits_every_count_is_that_from_nothing() {
    let (workshop, mut dice) = (Workshop::new(), Dice(7));
    let mut things: Vec<Thing> = (0..4).map(|place| dice.thing(place, 2 * place)).collect();
    let (file, cache) = (workshop.path("scene.glb"), workshop.path("cache"));
    scene(&things).write(&file);
    equation(&file, &cache);
    let (mut traced_now, mut traced_fresh) = (0, 0);
    let (mut aimed_now, mut aimed_fresh) = (0, 0);
    for number in 0..200 {
        let what = edit(&mut things, &mut dice, number);
        scene(&things).write(&file);
        let empty = tempfile::tempdir().expect("a folder");
        let (now, fresh) = (equation(&file, &cache), equation(&file, empty.path()));
        for (k, (now, fresh)) in now.coupled.iter().zip(&fresh.coupled).enumerate() {
            assert_eq!(now.coupling, fresh.coupling, "{what}: coupling of {k}");
            assert_eq!(now.sky, fresh.sky, "{what}: sky of {k}");
            let own = [now, fresh].map(|blocks| blocks.corrected.as_ref().map(|own| &own.self_block));
            assert_eq!(own[0], own[1], "{what}: self block of {k}");
        }
        assert_eq!(now.direct.irradiance, fresh.direct.irradiance, "{what}: light of sources");
        traced_now += traced(&now);
        traced_fresh += traced(&fresh);
        aimed_now += now.direct.computed;
        aimed_fresh += fresh.direct.computed;
    }
    // In a room with four crates each edit concerns a good part of it.
    assert!(traced_now < traced_fresh / 2, "{traced_now} rays, {traced_fresh} from nothing");
    // Boxes around a crate and what it lights fill much of a small room.
    assert!(
        aimed_now < aimed_fresh * 9 / 10,
        "{aimed_now} form factors of sources, {aimed_fresh} from nothing"
    );
}
