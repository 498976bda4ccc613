//! Lights, cameras, and settings in extras.

use crate::gltf::{Folder, Gltf, import, noted};
use equilux_bake::gltf_import::import_scene;
use equilux_formats::{LightKind, LocalSolver, Rgb, TexelChoice};
use glam::{DAffine3, DVec3};
use serde_json::json;
use std::f64::consts::PI;

#[test]
fn lights_and_cameras_stand_where_their_nodes_do() {
    let mut gltf = Gltf::with_square();
    gltf.json["extensionsRequired"] = json!(["KHR_lights_punctual"]);
    gltf.json["extensionsUsed"] = json!(["KHR_lights_punctual"]);
    gltf.json["extensions"] = json!({ "KHR_lights_punctual": { "lights": [
        { "type": "spot", "intensity": 4, "color": [1, 0.5, 0], "spot": { "innerConeAngle": 0.25, "outerConeAngle": 0.5 } },
        { "type": "point" }, { "type": "directional", "intensity": 3 },
    ] } });
    gltf.json["cameras"] = json!([
        { "type": "perspective", "perspective": { "yfov": 0.5, "aspectRatio": 1.5, "znear": 0.1 } },
        { "type": "orthographic", "orthographic": { "xmag": 1, "ymag": 1, "zfar": 9, "znear": 0 } },
    ]);
    let light = |index: usize| json!({ "KHR_lights_punctual": { "light": index } });
    gltf.nodes(json!([
        { "mesh": 0, "children": [5] },
        { "name": "spot", "translation": [1, 2, 3], "rotation": [1, 0, 0, 0], "scale": [2, 2, 2], "extensions": light(0) },
        { "name": "sun", "extensions": light(2), "extras": { "emission_scale": 2 } },
        { "name": "eye", "camera": 0, "translation": [4, 0, 0], "scale": [2, 3, 4] },
        { "name": "plan", "camera": 1 },
        { "name": "bulb", "translation": [0, 0, 1], "extensions": light(1) },
    ]));
    let scene = import(&gltf);
    let [bulb, spot, sun] = &scene.lights[..] else { panic!("three lights, found {:?}", scene.lights) };
    assert_eq!((bulb.kind, bulb.position, bulb.intensity), (LightKind::Point, DVec3::Z, Rgb::WHITE));
    assert_eq!(
        (spot.kind, spot.position),
        (LightKind::Spot { inner: 0.25, outer: 0.5 }, DVec3::new(1., 2., 3.))
    );
    assert_eq!((spot.direction, spot.intensity), (DVec3::Z, Rgb([4.0, 2.0, 0.0])));
    assert_eq!(
        (sun.kind, sun.direction, sun.intensity),
        (LightKind::Directional, DVec3::NEG_Z, Rgb::splat(6.0))
    );
    let [eye] = &scene.cameras[..] else { panic!("one camera, found {:?}", scene.cameras) };
    assert_eq!((eye.name.as_str(), eye.vertical_fov, eye.aspect), ("eye", 0.5, Some(1.5)));
    assert_eq!(eye.placement, DAffine3::from_translation(DVec3::X * 4.0), "cameras have no scale");
    assert!(noted(&scene, "camera plan: orthographic"), "{:?}", scene.notes);
}

#[test]
fn extras_reach_part_and_instance() {
    let mut gltf = Gltf::with_square();
    gltf = gltf.set("/materials/0/emissiveFactor", json!([1, 1, 1]));
    gltf.nodes(json!([
        { "name": "a", "mesh": 0, "extras": { "element_size": 0.25, "local_solver": "gauss-seidel", "other": [1] } },
        { "name": "b", "mesh": 0, "translation": [0, 0, 1], "extras": { "emission_scale": 0.5 }, "children": [2] },
        { "name": "c", "mesh": 0, "translation": [2, 0, 0], "extras": { "emission_scale": 4 } },
        { "name": "d", "mesh": 0, "translation": [0, 0, 2], "extras": "whatever" },
    ]));
    let scene = import(&gltf);
    let [a, b, _] = &scene.parts[..] else { panic!("three parts, found {}", scene.parts.len()) };
    assert_eq!((a.element_size, a.local_solver), (Some(0.25), Some(LocalSolver::GaussSeidel)));
    assert_eq!((b.element_size, b.local_solver), (None, None));
    let scales = scene.instances.iter().map(|i| i.emission_scale).collect::<Vec<_>>();
    assert_eq!(scales, [1.0, 0.5, 1.0], "a root's scale is its instance's");
    let emissions = b.materials.iter().map(|m| m.emission[0] / PI).collect::<Vec<_>>();
    assert_eq!(emissions, [1.0, 4.0], "below a root the scale is the material's");
}

#[test]
fn part_files_stand_at_their_nodes() {
    let folder = Folder::new();
    let mut lamp = Gltf::with_square();
    lamp.nodes(json!([
        { "mesh": 0, "translation": [0, 0, 5], "extras": { "element_size": 0.5 } },
        { "translation": [0, 0, 7], "extras": { "part": "inner/stand.glb" } },
    ]));
    folder.write("parts/lamp.glb", lamp.glb());
    let mut stand = Gltf::square_at(json!({ "scale": [3, 3, 3] }));
    stand = stand.set("/materials/0/name", json!("another grey"));
    folder.write("parts/inner/stand.glb", stand.glb());
    let mut hall = Gltf::with_square();
    hall.nodes(json!([
        { "name": "left", "translation": [10, 0, 0], "extras": { "part": "parts/lamp.glb", "emission_scale": 0 } },
        { "name": "right", "scale": [2, 2, 2], "extras": { "part": "parts/../parts/lamp.glb" } },
        { "name": "walls", "mesh": 0, "translation": [1, 0, 0], "children": [3] },
        { "name": "nested", "translation": [1, 0, 0], "extras": { "part": "parts/lamp.glb", "element_size": 2 } },
    ]));
    let file = folder.write("hall.glb", hall.glb());
    let scene = import_scene(&file).unwrap_or_else(|error| panic!("{error}"));

    let instances: Vec<_> =
        scene.instances.iter().map(|i| (i.name.as_str(), i.part.index(), i.placement.translation)).collect();
    let at = DVec3::new;
    let expected = [
        ("left", 0, at(10., 0., 5.)),
        ("right", 0, at(0., 0., 10.)),
        ("walls", 1, at(1., 0., 0.)),
        ("nested", 2, at(2., 0., 5.)),
    ];
    assert_eq!(instances, expected);
    assert_eq!(scene.instances[0].emission_scale, 0.0);
    let part = &scene.parts[0];
    assert_eq!((part.name.as_str(), part.surfaces.len(), part.materials.len()), ("lamp", 2, 2));
    assert_eq!((part.element_size, scene.parts[2].element_size), (Some(0.5), Some(2.0)));
    let sources =
        ["hall.glb", "parts/lamp.glb", "parts/inner/stand.glb"].map(|name| folder.0.path().join(name));
    assert_eq!(scene.sources, sources, "each file is read once");
}

/// Instances of one part may have other texels; within a part each surface has the choice of its node.
#[test]
fn texels_are_chosen_by_the_next_node_above_and_part_no_parts() {
    let mut gltf = Gltf::with_square();
    gltf.nodes(json!([
        { "name": "level", "children": [1, 2, 3], "extras": { "texel_size": 0.5 } },
        { "name": "1 near", "mesh": 0, "extras": { "texel_size": 0.01 } },
        { "name": "2 far", "mesh": 0, "translation": [0, 0, 3], "extras": { "lightmap": false } },
        { "name": "3 both", "mesh": 0, "translation": [0, 0, 6], "children": [4] },
        { "mesh": 0, "translation": [0, 0, 1], "extras": { "texel_size": 0.02, "lightmap": true } },
    ]));
    let scene = import(&gltf);
    let [near, far, both] = &scene.instances[..] else { panic!("three, found {:?}", scene.instances) };
    assert_eq!(near.part, far.part, "texels are no part of a part");
    let choice = |size: Option<f64>, any: Option<bool>| TexelChoice { size, any };
    assert_eq!(near.texels, choice(Some(0.01), None));
    assert_eq!(far.texels, choice(Some(0.5), Some(false)), "what it does not say, the node above does");
    assert_eq!(both.texels, choice(Some(0.5), None));
    let own: Vec<_> = scene.parts[both.part.index()].surfaces.iter().map(|s| s.texels).collect();
    assert_eq!(own, [TexelChoice::default(), choice(Some(0.02), Some(true))]);
}

#[test]
fn what_is_not_to_be_baked_is_as_if_it_were_not_there() {
    let mut gltf = Gltf::with_square();
    gltf.nodes(json!([
        { "name": "level", "children": [1, 2] },
        { "name": "floor", "mesh": 0 },
        { "name": "blocker", "mesh": 0, "translation": [0, 0, 3], "children": [3], "extras": { "bake": false } },
        { "name": "below it", "extras": { "part": "missing.glb" } },
        { "name": "rig", "mesh": 0, "extras": { "bake": false } },
    ]));
    let scene = import(&gltf);
    let names: Vec<&str> = scene.instances.iter().map(|instance| instance.name.as_str()).collect();
    assert_eq!(names, ["floor"], "the only root that is left wraps the others");
    let notes: Vec<&String> = scene.notes.iter().filter(|note| note.contains("\"bake\": false")).collect();
    assert!(notes.len() == 1 && notes[0].contains("blocker") && notes[0].contains("rig"), "{notes:?}");
}

#[test]
fn wrong_choices_of_texels_are_named() {
    for (key, value, expected) in [
        ("texel_size", json!(0), "above 0"),
        ("texel_size", json!("fine"), "above 0"),
        ("lightmap", json!("no"), "true or false"),
        ("bake", json!(0), "true or false"),
    ] {
        let mut gltf = Gltf::with_square();
        gltf.nodes(json!([{ "name": "wall", "mesh": 0, "extras": { key: value } }]));
        let folder = Folder::new();
        let file = folder.write("scene.glb", gltf.glb());
        let error = import_scene(&file).expect_err(key).to_string();
        assert!(["wall", key, expected, "scene.glb"].iter().all(|word| error.contains(word)), "{error}");
    }
}
