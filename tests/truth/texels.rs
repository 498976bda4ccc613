//! Texels as large as the truth's elements against its averages over them: direct light exact over each, reflected light
//! from a coarse solution. The level is modelled coarsely, as levels are; only the truth is cut finely.

use super::{Errors, gathered};
use equilux_bake::elements::ElementSize;
use equilux_bake::gltf_import::import_scene;
use equilux_bake::prepare::{Division, Preparation, prepare};
use equilux_bake::treecode::Resolution;
use equilux_bake::world::World;
use equilux_tests::averages::averages;
use equilux_tests::lit::lit;
use equilux_tests::table::Table;
use std::path::Path;

/// What averages may be off by, of the mean in RMS, besides the truth's own noise.
const TOLERANCE: f64 = 0.01;

#[test]
fn texels_of_wood_have_the_averages_of_path_tracing() {
    agrees("wood", 0.125, 0.01);
}

#[test]
fn texels_of_shadow_have_the_averages_of_path_tracing() {
    agrees("shadow", 0.25, 0.01);
}

#[test]
fn texels_of_cornell_have_the_averages_of_path_tracing() {
    agrees("cornell", 0.5, 0.03);
}

/// The scene with elements of so many metres.
fn agrees(name: &str, size: f64, tolerance: f64) {
    let here = Path::new(env!("CARGO_MANIFEST_DIR"));
    let (folder, coarse) = (here.join("../scenes").join(name), here.join(format!("truth/{name}.coarse.glb")));
    let resolution = Resolution::for_tolerance(tolerance);
    let wanted = |element_size| Preparation {
        element_size: Some(element_size),
        division: Division::Authored,
        resolution,
        local_solver: None,
    };
    let fine = import_scene(&folder.join(name).with_extension("glb")).expect("a scene");
    let fine = prepare(&fine, &wanted(ElementSize::Mesh)).expect("elements");
    let geometry = |i: &equilux_formats::Instance| (&fine.parts[i.part.index()].geometry, i.placement);
    let elements = World::new(fine.instances.iter().map(geometry)).elements;
    let light = averages(&lit(&coarse, &wanted(ElementSize::Metres(size))), &elements, resolution);

    let truth = Table::read(&folder.join("truth.csv"));
    let places = elements.iter().map(|e| (e.centroid, e.normal)).collect();
    let found = gathered(&truth, places, |row| (elements[row].area, light[row]));
    for (channel, colour) in ["r", "g", "b"].iter().enumerate() {
        let errors = Errors::of(&truth, &found, ["Ha", "Ha_se"].map(|k| format!("{k}_{colour}")), channel);
        println!("{name} {colour}: {errors}");
        assert!(
            errors.total <= TOLERANCE + errors.noise,
            "{name}, channel {colour}: averages are {errors} off, more than {TOLERANCE} and the noise"
        );
    }
}
