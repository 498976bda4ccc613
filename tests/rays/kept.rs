//! What is kept of rows by rays, and that nothing else changes a bit.

use equilux_tests::model::Model;
use equilux_tests::rooms::furnished;
use equilux_tests::workshop::{Ended, Workshop};
use serde_json::{Value, json};

/// Assembles the furnished room by rays, and returns the report.
fn assembled(workshop: &Workshop, scene: &str, more: &[&str]) -> Value {
    let common =
        [scene, "--rows", "rays", "--rays", "64", "--element-size", "0.4", "--pictures", "none", "--json"];
    let Ended { code, stdout, stderr } = workshop.run("assemble", &[&common[..], more].concat());
    assert_eq!(code, Some(0), "{stderr}");
    serde_json::from_str(&stdout).expect("a report")
}

/// The table of all elements of a run with a cache of its own.
fn table(workshop: &Workshop, scene: &str, name: &str, more: &[&str]) -> Vec<u8> {
    let (cache, table) = (format!("cache-{name}"), format!("{name}.csv"));
    assembled(workshop, scene, &[&["--cache", &cache, "--elements", &table], more].concat());
    std::fs::read(workshop.path(&table)).expect("a table")
}

#[test]
fn light_is_the_same_to_the_bit_on_any_number_of_threads() {
    let workshop = Workshop::with(&furnished());
    let one = table(&workshop, "scene.glb", "one", &["--threads", "1"]);
    for threads in ["2", "5"] {
        assert!(table(&workshop, "scene.glb", threads, &["--threads", threads]) == one, "{threads} threads");
    }
}

#[test]
fn light_is_the_same_to_the_bit_whatever_the_cache_holds() {
    let workshop = Workshop::with(&furnished());
    let from_nothing = table(&workshop, "scene.glb", "a", &[]);
    // The parts alone first, then the scene, and once more with everything in the cache.
    let baked = workshop.run(
        "bake",
        &["scene.glb", "--rows", "rays", "--rays", "64", "--element-size", "0.4", "--cache", "cache-b"],
    );
    assert_eq!(baked.code, Some(0), "{}", baked.stderr);
    assert!(table(&workshop, "scene.glb", "b", &[]) == from_nothing, "with baked parts");
    assert!(table(&workshop, "scene.glb", "b", &[]) == from_nothing, "with everything cached");
    let again = assembled(&workshop, "scene.glb", &["--cache", "cache-b"]);
    assert_eq!(again["form_factors_computed"], json!(0));
    assert_eq!(again["notes"], json!([]), "nothing in the cache is damaged");
}

#[test]
fn a_lamp_dimmed_or_a_wall_painted_costs_no_rays() {
    let workshop = Workshop::with(&furnished());
    let before = assembled(&workshop, "scene.glb", &[]);
    let mut nodes = furnished();
    for material in nodes.iter_mut().flat_map(|node| node.part.as_mut()).flat_map(|part| &mut part.materials)
    {
        material.emission = material.emission * 0.5;
        material.reflectance = material.reflectance * 0.5;
    }
    Model::of(&nodes).write(&workshop.path("scene.glb"));
    let after = assembled(&workshop, "scene.glb", &[]);
    assert!(before["form_factors_computed"].as_u64() > Some(0));
    assert_eq!(after["form_factors_computed"], json!(0));
    assert_ne!(before["energy"]["emitted"], after["energy"]["emitted"]);
}
