//! Containers, buffers and accessors: the same scene from each of them.

use crate::gltf::{Folder, Gltf, HALVES, I16, SQUARE, U8, U16, import, noted, placed_corners, square};
use equilux_bake::gltf_import::import_scene;
use glam::DVec3;
use serde_json::json;

#[test]
fn every_container_holds_the_same_scene() {
    let gltf = Gltf::square_at(json!({ "name": "hall" }));
    let folder = Folder::new();
    folder.write("data/my square.bin", &gltf.bytes);
    for (name, bytes, sources) in [
        ("scene.glb", gltf.glb(), 1),
        ("embedded.gltf", gltf.text(None), 1),
        ("external.gltf", gltf.text(Some("data/my%20square.bin")), 2),
    ] {
        let file = folder.write(name, bytes);
        let scene = import_scene(&file).unwrap_or_else(|error| panic!("{error}"));
        assert_eq!(placed_corners(&scene), square(), "{name}");
        assert_eq!((scene.name.as_str(), &scene.file), (name.split('.').next().unwrap_or(name), &file));
        assert_eq!((scene.sources.len(), &scene.sources[0]), (sources, &file), "{:?}", scene.sources);
        assert_eq!(scene.notes, Vec::<String>::new(), "{name}");
    }
}

#[test]
fn each_component_type_reads_the_same_square() {
    let quantised: [[i16; 3]; 4] = SQUARE.map(|corner| corner.map(|x| x as i16));
    let i16s = |factor: i16| {
        quantised.iter().flatten().flat_map(|x| (x * factor).to_le_bytes()).collect::<Vec<u8>>()
    };
    let u8s = |factor: u8| quantised.iter().flatten().map(|&x| x as u8 * factor).collect::<Vec<u8>>();
    // 16-bit corners padded to 8 bytes, as the specification wants them.
    let strided: Vec<u8> =
        quantised.iter().flat_map(|c| [c[0], c[1], c[2], 0]).flat_map(i16::to_le_bytes).collect();
    for (case, component, bytes, normalised, stride) in [
        ("i16", I16, i16s(1), false, None),
        ("normalised i16", I16, i16s(i16::MAX), true, None),
        ("u16", U16, i16s(1), false, None),
        ("i8", 5120, u8s(1), false, None),
        ("normalised i8", 5120, u8s(127), true, None),
        ("u8", U8, u8s(1), false, None),
        ("normalised u8", U8, u8s(255), true, None),
        ("strided i16", I16, strided, false, Some(8)),
    ] {
        let mut gltf = Gltf::square_at(json!({}));
        let accessor = gltf.accessor(&bytes, component, "VEC3", 4);
        gltf.json["accessors"][accessor]["normalized"] = json!(normalised);
        gltf.json["bufferViews"][accessor]["byteStride"] = json!(stride);
        gltf.json["extensionsRequired"] = json!(["KHR_mesh_quantization"]);
        let gltf = gltf.set("/meshes/0/primitives/0/attributes/POSITION", json!(accessor));
        assert_eq!(placed_corners(&import(&gltf)), square(), "{case}");
    }
    for (component, bytes) in [
        (U8, HALVES.map(|i| i as u8).to_vec()),
        (U16, HALVES.iter().flat_map(|&i| (i as u16).to_le_bytes()).collect()),
    ] {
        let mut gltf = Gltf::square_at(json!({}));
        let accessor = gltf.accessor(&bytes, component, "SCALAR", 6);
        let gltf = gltf.set("/meshes/0/primitives/0/indices", json!(accessor));
        assert_eq!(placed_corners(&import(&gltf)), square(), "indices of type {component}");
    }
}

/// The square with its last two corners moved out by sparse values, upon a buffer view and upon zeros.
#[test]
fn sparse_values_replace_what_lies_below() {
    for upon_view in [true, false] {
        let mut gltf = Gltf::square_at(json!({}));
        let at = gltf.view(&if upon_view { vec![2_u8, 3] } else { vec![1_u8, 2, 3] });
        let new = [[1_f32, 0., 0.], [1., 4., 0.], [0., 4., 0.]];
        let new = &new[usize::from(upon_view)..];
        let values = gltf.view(&new.iter().flatten().flat_map(|x| x.to_le_bytes()).collect::<Vec<u8>>());
        let sparse = json!({
            "count": new.len(),
            "indices": { "bufferView": at, "componentType": U8 },
            "values": { "bufferView": values },
        });
        gltf.json["accessors"][0]["sparse"] = sparse;
        if !upon_view {
            gltf.json["accessors"][0].as_object_mut().expect("an accessor").remove("bufferView");
        }
        let expected = square()[0].iter().map(|&corner| corner * DVec3::new(1., 4., 1.)).collect::<Vec<_>>();
        assert_eq!(placed_corners(&import(&gltf)), [expected], "upon a view: {upon_view}");
    }
}

#[test]
fn lists_strips_and_fans_make_the_same_quad() {
    let strip = [SQUARE[0], SQUARE[1], SQUARE[3], SQUARE[2]];
    let list = HALVES.map(|i| SQUARE[i as usize]);
    for (mode, corners) in [(4, &list[..]), (5, &strip[..]), (6, &SQUARE[..])] {
        let mut gltf = Gltf::square_at(json!({}));
        let positions = gltf.positions(corners);
        let primitive = json!({ "attributes": { "POSITION": positions }, "mode": mode, "material": 0 });
        let scene = import(&gltf.set("/meshes/0/primitives/0", primitive));
        let surface = scene.parts[0].surfaces[0].corners;
        assert_eq!((scene.parts[0].surfaces.len(), surface.as_slice().len()), (1, 4), "mode {mode}");
        assert_eq!(surface.double_area_vector(), DVec3::Z * 2.0, "mode {mode}");
    }
    for mode in 0..4 {
        let mut gltf = Gltf::square_at(json!({}));
        let loose = json!({ "attributes": { "POSITION": 0 }, "mode": mode });
        gltf.json["meshes"][0]["primitives"].as_array_mut().expect("primitives").push(loose);
        let scene = import(&gltf);
        assert_eq!(placed_corners(&scene), square(), "mode {mode}");
        assert!(noted(&scene, "points and lines"), "mode {mode}: {:?}", scene.notes);
    }
}
