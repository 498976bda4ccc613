//! Conversion of materials, and notes about unused properties.

use crate::gltf::{Gltf, SQUARE, import, noted};
use equilux_formats::Rgb;
use serde_json::{Value, json};
use std::f64::consts::PI;

#[test]
fn materials_become_reflectance_and_emission() {
    let material = json!({
        "name": "lamp", "doubleSided": true,
        "emissiveFactor": [1, 0.5, 0], "extensions": { "KHR_materials_emissive_strength": { "emissiveStrength": 8 } },
        "pbrMetallicRoughness": { "baseColorFactor": [0.25, 0.5, 1, 1], "metallicFactor": 0 },
    });
    let scene = import(&Gltf::square_at(json!({})).set("/materials/0", material));
    let lamp = &scene.parts[0].materials[0];
    assert_eq!(
        (lamp.name.as_str(), lamp.double_sided, lamp.reflectance),
        ("lamp", true, Rgb([0.25, 0.5, 1.0]))
    );
    assert_eq!(lamp.emission, [8.0 * PI, 4.0 * PI, 0.0]);
    assert_eq!(scene.notes, Vec::<String>::new());
}

#[test]
fn what_radiosity_has_no_use_for_is_noted() {
    // The image of a texture that is not used is not read.
    let image = json!([{ "uri": "missing.png" }]);
    let square = || Gltf::square_at(json!({ "name": "hall" }));
    let without_material =
        square().set("/meshes/0/primitives/0", json!({ "attributes": { "POSITION": 0 }, "indices": 1 }));
    let textured = square().set("/materials/0/normalTexture", json!({ "index": 0 })).set("/images", image);
    for (note, gltf) in [
        ("mesh square: no material", without_material),
        ("material grey: textures are ignored", textured.set("/textures", json!([{ "source": 0 }]))),
        (
            "material grey: metallic",
            square().set("/materials/0/pbrMetallicRoughness/metallicFactor", json!(0.5)),
        ),
        (
            "material grey: lets light through",
            square().set("/materials/0/extensions", json!({ "KHR_materials_transmission": {} })),
        ),
        ("material grey: transparent", square().set("/materials/0/alphaMode", json!("BLEND"))),
        (
            "extension KHR_texture_basisu is ignored",
            square().set("/extensionsUsed", json!(["KHR_texture_basisu"])),
        ),
        ("several scenes", square().set("/scenes", json!([{ "nodes": [0] }, { "nodes": [] }]))),
        ("animations", square().set("/animations", json!([{ "channels": [], "samplers": [] }]))),
    ] {
        let scene = import(&gltf);
        assert!(noted(&scene, note), "expected a note on '{note}', found {:?}", scene.notes);
    }
}

#[test]
fn no_material_is_white_and_equal_materials_of_one_name_are_one() {
    let mut gltf = Gltf::square_at(json!({}));
    gltf.push("materials", json!({ "name": "twin", "pbrMetallicRoughness": { "baseColorFactor": [0.5, 0.5, 0.5, 1], "metallicFactor": 0 } }));
    let other = gltf.positions(&SQUARE.map(|[x, y, z]| [x + 2.0, y, z]));
    let primitive = |positions: usize, material: Value| json!({ "attributes": { "POSITION": positions }, "indices": 1, "material": material });
    let twins = gltf.set("/meshes/0/primitives", json!([primitive(0, json!(0)), primitive(other, json!(1))]));
    let part = &import(&twins).parts[0];
    assert_eq!((part.surfaces.len(), part.materials.len()), (2, 2), "each can be repainted by its name");
    let twins = twins.set("/materials/1/name", json!("grey"));
    assert_eq!(import(&twins).parts[0].materials.len(), 1);
    let white = twins.set("/meshes/0/primitives", json!([primitive(0, Value::Null)]));
    assert_eq!(import(&white).parts[0].materials[0].reflectance, [1.0; 3]);
}
