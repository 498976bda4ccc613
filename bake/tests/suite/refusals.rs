//! Inconsistent files are refused with an error that names the faulty object.

use crate::gltf::{F32, Folder, Gltf, HALVES, SQUARE, U8, U32};
use equilux_bake::gltf_import::import_scene;
use serde_json::{Value, json};
use std::path::Path;

/// Imports `file`, which must be refused with a message that names `culprit` and holds `words`.
pub fn refused(case: &str, file: &Path, culprit: &str, words: &str) {
    match import_scene(file) {
        Ok(scene) => panic!("{case}: accepted, with the notes {:?}", scene.notes),
        Err(error) => {
            let message = error.to_string();
            assert!(message.contains(culprit), "{case}: '{message}' does not name {culprit}");
            assert!(message.contains(words), "{case}: '{message}' does not say '{words}'");
        }
    }
}

fn square() -> Gltf {
    Gltf::square_at(json!({ "name": "hall" }))
}

/// Each file is refused with its words.
fn all_refused<const N: usize>(cases: [(&str, Gltf); N]) {
    for (words, gltf) in cases {
        let folder = Folder::new();
        refused(words, &folder.write("scene.glb", gltf.glb()), "scene.glb", words);
    }
}

fn extras(extras: Value) -> Gltf {
    square().set("/nodes/0/extras", extras)
}

#[test]
fn contradictory_accessors_are_refused() {
    let positions = |positions: &[[f32; 3]]| Gltf::of_triangles(positions, &HALVES);
    let (mut nan, mut infinite) = (SQUARE, SQUARE);
    (nan[3][1], infinite[2][0]) = (f32::NAN, f32::INFINITY);
    all_refused([
        ("4 elements reach past", square().set("/bufferViews/0/byteLength", json!(40))),
        ("1000000 elements reach past", square().set("/accessors/0/count", json!(1_000_000))),
        ("elements reach past", square().set("/accessors/0/byteOffset", json!(u64::MAX))),
        ("reaches past its buffer", square().set("/bufferViews/0/byteOffset", json!(9999))),
        ("reaches past its buffer", square().set("/bufferViews/0/byteOffset", json!(u64::MAX))),
        ("stride of 4 bytes", square().set("/bufferViews/0/byteStride", json!(4))),
        ("at most 67108864 elements", endless()),
        ("Vec3", square().set("/accessors/0/type", json!("VEC2"))),
        ("as Vec3 of U32", square().set("/accessors/0/componentType", json!(U32))),
        ("as Scalar of F32", square().set("/accessors/1/componentType", json!(F32))),
        ("POSITION names accessor 77", square().set("/meshes/0/primitives/0/attributes/POSITION", json!(77))),
        ("out of bounds", square().set("/meshes/0/primitives/0/indices", json!(77))),
        ("as an unknown type of F32", square().set("/accessors/0/type", json!("VEC9"))),
        ("as Vec3 of an unknown type", square().set("/accessors/0/componentType", json!(5130))),
        ("sparse index 4", sparse(4)),
        ("index 4", Gltf::of_triangles(&SQUARE, &[0, 1, 4])),
        ("index 4294967295", Gltf::of_triangles(&SQUARE, &[0, 1, u32::MAX])),
        ("mesh hall in accessor 2 with vertex 3", positions(&nan)),
        ("mesh hall in accessor 2 with vertex 2", positions(&infinite)),
    ]);
}

/// The square with one sparse value, of this vertex.
fn sparse(index: u8) -> Gltf {
    let mut gltf = square();
    let (at, values) = (gltf.view(&[index]), gltf.view(&[0; 12]));
    let indices = json!({ "bufferView": at, "componentType": U8 });
    gltf.json["accessors"][0]["sparse"] =
        json!({ "count": 1, "indices": indices, "values": { "bufferView": values } });
    gltf
}

/// A few bytes that claim to be 2^60 vertices.
fn endless() -> Gltf {
    let mut endless = Gltf::with_square();
    endless.json["accessors"][0] = json!({
        "componentType": F32, "type": "VEC3", "count": 1_u64 << 60,
        "sparse": { "count": 1, "indices": { "bufferView": 1, "componentType": U8 }, "values": { "bufferView": 0 } },
    });
    endless.nodes(json!([{ "mesh": 0 }]));
    endless
}

#[test]
fn hierarchies_that_are_no_trees_and_transforms_without_meaning_are_refused() {
    let nodes = |nodes: Value, roots: Value| {
        let mut gltf = Gltf::with_square().set("/scenes", json!([{ "nodes": roots }]));
        gltf.nodes(nodes);
        gltf
    };
    all_refused([
        (
            "node a is below itself, a cycle",
            nodes(json!([{ "name": "a", "children": [1] }, { "children": [0] }]), json!([0])),
        ),
        (
            "node a is below itself, a cycle",
            nodes(json!([{ "name": "a", "mesh": 0, "children": [0] }]), json!([0])),
        ),
        (
            "node c hangs in two places",
            nodes(
                json!([{ "children": [2] }, { "children": [2] }, { "name": "c", "mesh": 0 }]),
                json!([0, 1]),
            ),
        ),
        ("no surfaces", nodes(json!([{ "children": [1] }, { "children": [0] }]), json!([]))),
        ("out of bounds", nodes(json!([{ "children": [9] }]), json!([0]))),
        ("node hall with a transform", square().set("/nodes/0/translation", json!([0, 1e39, 0]))),
        ("node hall with a rotation", square().set("/nodes/0/rotation", json!([0, 0, 0, 0]))),
        (
            "node hall with a projective",
            square().set("/nodes/0/matrix", json!([1, 0, 0, 1, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1])),
        ),
    ]);
}

#[test]
fn materials_outside_of_physics_are_refused() {
    let factor = |pointer: &str, value: Value| square().set(pointer, value);
    all_refused([
        ("rho [1.5", factor("/materials/0/pbrMetallicRoughness/baseColorFactor", json!([1.5, 0, 0, 1]))),
        (
            "rho [0.0, -0.5",
            factor("/materials/0/pbrMetallicRoughness/baseColorFactor", json!([0, -0.5, 0, 1])),
        ),
        ("material grey with the radiance", factor("/materials/0/emissiveFactor", json!([0, -1, 0]))),
        ("material grey with the radiance", factor("/materials/0/emissiveFactor", json!([0, 1e39, 0]))),
    ]);
}

#[test]
fn impossible_lights_and_cameras_are_refused() {
    let lens = |lens: Value| {
        let mut gltf = square().set("/nodes/0/camera", json!(0));
        gltf.json["cameras"] = json!([{ "type": "perspective", "perspective": lens }]);
        gltf
    };
    let light = |light: Value| {
        square()
            .set("/extensions", json!({ "KHR_lights_punctual": { "lights": [light] } }))
            .set("/nodes/0/extensions", json!({ "KHR_lights_punctual": { "light": 0 } }))
    };
    all_refused([
        ("yfov 0", lens(json!({ "yfov": 0, "znear": 0.1 }))),
        ("aspectRatio Some(-1", lens(json!({ "yfov": 1, "aspectRatio": -1, "znear": 0.1 }))),
        ("light hall with the intensity", light(json!({ "type": "point", "intensity": -1 }))),
        (
            "light hall with innerConeAngle 1 and outerConeAngle 0.5",
            light(json!({ "type": "spot", "spot": { "innerConeAngle": 1, "outerConeAngle": 0.5 } })),
        ),
        ("innerConeAngle 0.9", light(json!({ "type": "spot", "spot": { "innerConeAngle": 0.9 } }))),
        ("outerConeAngle 0;", light(json!({ "type": "spot", "spot": { "outerConeAngle": 0 } }))),
        ("outerConeAngle 1.7", light(json!({ "type": "spot", "spot": { "outerConeAngle": 1.7 } }))),
    ]);
}

#[test]
fn extras_without_meaning_and_files_elsewhere_are_refused() {
    all_refused([
        ("node hall with element_size = 0", extras(json!({ "element_size": 0 }))),
        ("node hall with element_size = \"1\"", extras(json!({ "element_size": "1" }))),
        ("node hall with emission_scale = -1", extras(json!({ "emission_scale": -1 }))),
        ("node hall with local_solver = \"magic\"", extras(json!({ "local_solver": "magic" }))),
        ("node hall with part = 7", extras(json!({ "part": 7 }))),
        ("URL", extras(json!({ "part": "https://example.org/lamp.glb" }))),
        ("URL or an absolute path", extras(json!({ "part": "C:\\lamp.glb" }))),
        ("absolute path", extras(json!({ "part": "/etc/lamp.glb" }))),
        ("leaves the scene's folder", extras(json!({ "part": "parts/../../lamp.glb" }))),
        ("lamp.glb cannot be read", extras(json!({ "part": "lamp.glb" }))),
        ("cycle of part files: scene.glb → scene.glb", extras(json!({ "part": "scene.glb" }))),
    ]);
}

#[test]
fn what_is_no_scene_is_refused() {
    let node = |node: Value| {
        let mut gltf = Gltf::with_square();
        gltf.nodes(json!([node, { "name": "door", "mesh": 0 }]));
        gltf
    };
    all_refused([
        ("no surfaces", square().set("/nodes", json!([]))),
        ("no surfaces", square().set("/nodes/0/scale", json!([0, 0, 0]))),
        (
            "requires the extension KHR_texture_basisu",
            square().set("/extensionsRequired", json!(["KHR_texture_basisu"])),
        ),
        ("asset.version is '1.0'", square().set("/asset/version", json!("1.0"))),
        ("asset.minVersion is '2.1'", square().set("/asset/minVersion", json!("2.1"))),
        ("no surfaces", node(json!({})).set("/nodes/1", json!({ "name": "empty" }))),
    ]);
}
