//! The importer's contract, on small files written here: what each feature of glTF becomes, what is left out with a
//! note, and what is refused. Coordinates are small dyadic numbers, so equality is exact unless a tolerance says why not.
//!
//! Long because it is one set of tables over one writer of glTF files: containers, hierarchy, surfaces, materials,
//! lights, extras, refusals.

use base64::Engine as _;
use base64::prelude::BASE64_STANDARD;
use equilux_bake::gltf_import::import_scene;
use equilux_formats::{LightKind, LocalSolver, Rgb, Scene};
use glam::{DAffine3, DMat3, DVec3};
use serde_json::{Value, json};
use std::f64::consts::PI;
use std::fs;
use std::path::{Path, PathBuf};
use tempfile::TempDir;

const U8: u32 = 5121;
const U16: u32 = 5123;
const I16: u32 = 5122;
const U32: u32 = 5125;
const F32: u32 = 5126;

const SQUARE: [[f32; 3]; 4] = [[0., 0., 0.], [1., 0., 0.], [1., 1., 0.], [0., 1., 0.]];
const HALVES: [u32; 6] = [0, 1, 2, 0, 2, 3];

/// A glTF file in the making.
struct Gltf {
    json: Value,
    bytes: Vec<u8>,
}

impl Gltf {
    /// No nodes; mesh 0 is a unit square of two triangles in z = 0 with the grey material 0.
    fn with_square() -> Self {
        let json = json!({
            "asset": { "version": "2.0" },
            "materials": [{ "name": "grey", "pbrMetallicRoughness": { "baseColorFactor": [0.5, 0.5, 0.5, 1], "metallicFactor": 0 } }],
        });
        let mut gltf = Self { json, bytes: Vec::new() };
        let (positions, indices) = (gltf.positions(&SQUARE), gltf.indices(&HALVES));
        gltf.mesh(
            "square",
            json!({ "attributes": { "POSITION": positions }, "indices": indices, "material": 0 }),
        );
        gltf
    }

    /// The square at one node.
    fn square_at(node: Value) -> Self {
        let mut gltf = Self::with_square();
        let mut node = node;
        node["mesh"] = json!(0);
        gltf.nodes(json!([node]));
        gltf
    }

    /// A mesh of these triangles at a node called `hall`, instead of the square.
    fn of_triangles(positions: &[[f32; 3]], indices: &[u32]) -> Self {
        let mut gltf = Self::square_at(json!({ "name": "hall" }));
        let (positions, indices) = (gltf.positions(positions), gltf.indices(indices));
        let primitive = json!({ "attributes": { "POSITION": positions }, "indices": indices, "material": 0 });
        gltf.json["meshes"] = json!([{ "name": "hall", "primitives": [primitive] }]);
        gltf
    }

    fn set(mut self, pointer: &str, value: Value) -> Self {
        let (parent, key) = pointer.rsplit_once('/').expect("a JSON pointer");
        let parent = self.json.pointer_mut(parent).unwrap_or_else(|| panic!("nothing at {parent}"));
        match parent {
            Value::Array(items) => items[key.parse::<usize>().expect("an index")] = value,
            other => other[key] = value,
        }
        self
    }

    fn push(&mut self, list: &str, value: Value) -> usize {
        if self.json[list].is_null() {
            self.json[list] = json!([]);
        }
        let list = self.json[list].as_array_mut().expect("a list");
        list.push(value);
        list.len() - 1
    }

    /// Nodes of which those that are no other's child are the scene's roots.
    fn nodes(&mut self, nodes: Value) {
        self.json["nodes"] = nodes;
    }

    fn view(&mut self, bytes: &[u8]) -> usize {
        self.bytes.resize(self.bytes.len().next_multiple_of(4), 0);
        let offset = self.bytes.len();
        self.bytes.extend_from_slice(bytes);
        self.push("bufferViews", json!({ "buffer": 0, "byteOffset": offset, "byteLength": bytes.len() }))
    }

    fn accessor(&mut self, bytes: &[u8], component: u32, kind: &str, count: usize) -> usize {
        let view = self.view(bytes);
        self.push(
            "accessors",
            json!({ "bufferView": view, "componentType": component, "type": kind, "count": count }),
        )
    }

    fn positions(&mut self, positions: &[[f32; 3]]) -> usize {
        let bytes: Vec<u8> = positions.iter().flatten().flat_map(|x| x.to_le_bytes()).collect();
        self.accessor(&bytes, F32, "VEC3", positions.len())
    }

    fn indices(&mut self, indices: &[u32]) -> usize {
        let bytes: Vec<u8> = indices.iter().flat_map(|i| i.to_le_bytes()).collect();
        self.accessor(&bytes, U32, "SCALAR", indices.len())
    }

    fn mesh(&mut self, name: &str, primitive: Value) -> usize {
        self.push("meshes", json!({ "name": name, "primitives": [primitive] }))
    }

    fn glb(&self) -> Vec<u8> {
        let mut json = self.json.clone();
        json["buffers"] = json!([{ "byteLength": self.bytes.len() }]);
        container(json.to_string().as_bytes(), &self.bytes)
    }

    /// A `.gltf` whose buffer lies at `uri`, or in the file.
    fn text(&self, uri: Option<&str>) -> Vec<u8> {
        let embedded =
            || format!("data:application/octet-stream;base64,{}", BASE64_STANDARD.encode(&self.bytes));
        let mut json = self.json.clone();
        json["buffers"] =
            json!([{ "byteLength": self.bytes.len(), "uri": uri.map_or_else(embedded, str::to_owned) }]);
        json.to_string().into_bytes()
    }
}

fn container(json: &[u8], binary: &[u8]) -> Vec<u8> {
    let padded = |bytes: &[u8], with: u8| {
        let mut bytes = bytes.to_vec();
        bytes.resize(bytes.len().next_multiple_of(4), with);
        bytes
    };
    let (json, binary) = (padded(json, b' '), padded(binary, 0));
    let length = 12 + 8 + json.len() + 8 + binary.len();
    let numbers =
        |values: &[usize]| values.iter().flat_map(|&v| (v as u32).to_le_bytes()).collect::<Vec<u8>>();
    [
        b"glTF".to_vec(),
        numbers(&[2, length, json.len()]),
        b"JSON".to_vec(),
        json,
        numbers(&[binary.len()]),
        b"BIN\0".to_vec(),
        binary,
    ]
    .concat()
}

struct Folder(TempDir);

impl Folder {
    fn new() -> Self {
        Self(tempfile::tempdir().expect("a temporary folder"))
    }

    fn write(&self, name: &str, bytes: impl AsRef<[u8]>) -> PathBuf {
        let path = self.0.path().join(name);
        fs::create_dir_all(path.parent().expect("a folder")).expect("a folder");
        fs::write(&path, bytes).expect("a written file");
        path
    }
}

fn import(gltf: &Gltf) -> Scene {
    let folder = Folder::new();
    import_scene(&folder.write("scene.glb", gltf.glb())).unwrap_or_else(|error| panic!("{error}"))
}

/// Corners of all surfaces of all instances, in the scene.
fn placed_corners(scene: &Scene) -> Vec<Vec<DVec3>> {
    let surfaces = |instance: &equilux_formats::Instance| {
        let surfaces = scene.parts[instance.part.index()].surfaces.clone();
        let placement = instance.placement;
        surfaces
            .into_iter()
            .map(move |s| s.corners.as_slice().iter().map(|&p| placement.transform_point3(p)).collect())
    };
    scene.instances.iter().flat_map(surfaces).collect()
}

fn square() -> Vec<Vec<DVec3>> {
    vec![SQUARE.map(|corner| DVec3::from_array(corner.map(f64::from))).to_vec()]
}

fn noted(scene: &Scene, words: &str) -> bool {
    scene.notes.iter().any(|note| note.contains(words))
}

// ---- containers and buffers ------------------------------------------------------------------------------------

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

// ---- hierarchy and placement ----------------------------------------------------------------------------------

#[test]
fn transforms_place_the_square_where_gltf_says() {
    let half = 0.5_f64.sqrt();
    let quarter = json!([0, 0, half, half]);
    let matrix = json!([0, 2, 0, 0, -2, 0, 0, 0, 0, 0, 2, 0, 5, 6, 7, 1]);
    for (case, node, expected) in [
        ("translation", json!({ "translation": [5, 6, 7] }), [[5., 6., 7.], [6., 6., 7.], [6., 7., 7.]]),
        (
            "turn",
            json!({ "rotation": quarter, "scale": [2, 2, 2] }),
            [[0., 0., 0.], [0., 2., 0.], [-2., 2., 0.]],
        ),
        ("matrix", json!({ "matrix": matrix }), [[5., 6., 7.], [5., 8., 7.], [3., 8., 7.]]),
        ("stretch", json!({ "scale": [2, 3, 4] }), [[0., 0., 0.], [2., 0., 0.], [2., 3., 0.]]),
        (
            "stretched turn",
            json!({ "rotation": quarter, "scale": [2, 3, 1] }),
            [[0., 0., 0.], [0., 2., 0.], [-3., 2., 0.]],
        ),
    ] {
        let corners = placed_corners(&import(&Gltf::square_at(node)));
        for (found, expected) in corners[0].iter().zip(expected.map(DVec3::from_array)) {
            // The quaternion comes as f32 and is normalised in f64: 1 ulp of f32 in a length of 3.
            assert!((*found - expected).length() < 1e-6, "{case}: {found}, expected {expected}");
        }
    }
}

#[test]
fn placements_are_similarities_and_fronts_stay_in_front() {
    let child = |scale: Value| json!([{ "name": "a", "mesh": 0, "children": [1] }, { "mesh": 0, "translation": [3, 0, 0], "scale": scale }]);
    let root = |scale: Value| json!([{ "name": "a", "mesh": 0, "scale": scale }]);
    for (case, nodes) in [
        ("mirrored root", root(json!([-1, 1, 1]))),
        ("mirrored and stretched root", root(json!([-2, 1, 1]))),
        ("mirrored child", child(json!([-1, 1, 1]))),
        ("stretched child", child(json!([1, 5, 1]))),
    ] {
        let mut gltf = Gltf::with_square();
        gltf.nodes(nodes);
        let scene = import(&gltf);
        let linear = scene.instances[0].placement.matrix3;
        let gram = linear.transpose() * linear;
        assert!(
            gram.abs_diff_eq(DMat3::from_diagonal(DVec3::splat(gram.x_axis.x)), 1e-12),
            "{case}: {linear}"
        );
        for surface in &scene.parts[0].surfaces {
            // The map of a front is the front of the map; z is left alone by all of these.
            let front = linear * surface.corners.double_area_vector();
            assert!(front.z > 0.0 && front.x == 0.0 && front.y == 0.0, "{case}: front {front}");
        }
    }
}

#[test]
fn parts_start_at_zero_and_far_ones_keep_their_digits() {
    let far = SQUARE.map(|[x, y, z]| [x + 1e6, y - 1e6, z + 2.0]);
    let mut gltf = Gltf::of_triangles(&far, &HALVES);
    gltf.mesh("near", json!({ "attributes": { "POSITION": 0 }, "indices": 1, "material": 0 }));
    gltf.nodes(json!([{ "name": "far", "mesh": 0, "translation": [0, 0, 1] },
               { "name": "near", "mesh": 1, "translation": [1e6, -1e6, 0] }]));
    let scene = import(&gltf);
    assert_eq!(scene.parts.len(), 1, "equal shapes at different places are one part");
    assert_eq!(scene.parts[0].name, "far");
    let corners: Vec<DVec3> = scene.parts[0].surfaces[0].corners.as_slice().to_vec();
    assert_eq!(corners, square()[0]);
    let file_from_part = DAffine3::from_translation(scene.origin) * scene.instances[0].placement;
    assert_eq!(file_from_part, DAffine3::from_translation(DVec3::new(1e6, -1e6, 3.0)));
    assert!(
        scene.instances[0].placement.translation.length() < 100.0,
        "the scene is moved close to its origin"
    );
}

#[test]
fn roots_are_parts_and_wrappers_are_looked_through() {
    let names = |nodes: Value| {
        let mut gltf = Gltf::with_square();
        gltf.push("cameras", json!({ "type": "perspective", "perspective": { "yfov": 1, "znear": 0.1 } }));
        gltf.nodes(nodes);
        let scene = import(&gltf);
        (scene.instances.iter().map(|i| i.name.clone()).collect::<Vec<_>>().join(" "), scene.parts.len())
    };
    // Each in a place of its own, as what lies on each other counts once.
    let leaf = |name: &str| {
        let place = f64::from(name.as_bytes()[0]);
        json!({ "name": name, "mesh": 0, "translation": [3.0 * place, 0, 0] })
    };
    let stretched = json!({ "name": "b", "mesh": 0, "scale": [2, 1, 1] });
    for (case, nodes, instances, parts) in [
        ("one", json!([leaf("a")]), "a", 1),
        ("shared mesh", json!([leaf("a"), { "name": "b", "mesh": 0, "scale": [3, 3, -3] }]), "a b", 1),
        ("stretch", json!([leaf("a"), stretched]), "a b", 2),
        ("wrapper", json!([{ "name": "w", "children": [1, 2] }, leaf("a"), leaf("b")]), "a b", 1),
        ("wrappers", json!([{ "children": [1] }, { "children": [2] }, leaf("a")]), "a", 1),
        ("not a wrapper", json!([{ "name": "w", "camera": 0, "children": [1] }, leaf("a")]), "w", 1),
        (
            "wish",
            json!([{ "name": "w", "extras": { "element_size": 1 }, "children": [1, 2] }, leaf("a"), { "mesh": 0, "translation": [2, 0, 0] }]),
            "w",
            1,
        ),
        ("beside", json!([leaf("a"), { "name": "empty" }, { "name": "eye", "camera": 0 }]), "a", 1),
        (
            "subtrees",
            json!([{ "name": "a", "children": [2] }, { "name": "b", "children": [3] }, leaf("c"), leaf("d")]),
            "a b",
            1,
        ),
        ("nameless", json!([{ "mesh": 0 }]), "square", 1),
    ] {
        assert_eq!(names(nodes), (instances.to_owned(), parts), "{case}");
    }
}

#[test]
fn a_wrappers_transform_reaches_the_placements() {
    let mut gltf = Gltf::with_square();
    gltf.nodes(json!([{ "children": [1, 2], "scale": [2, 2, 2] }, { "mesh": 0, "translation": [1, 0, 0] }, { "mesh": 0 }]));
    let scene = import(&gltf);
    let origins = scene.instances.iter().map(|i| i.placement.translation).collect::<Vec<_>>();
    assert_eq!(origins, [DVec3::X * 2.0, DVec3::ZERO]);
}

#[test]
fn a_chain_of_many_nodes_neither_recurses_nor_takes_long() {
    let depth = 100_000;
    let mut nodes: Vec<Value> = (0..depth).map(|i| json!({ "children": [i + 1] })).collect();
    nodes[0]["extras"] = json!({ "element_size": 0.5 });
    nodes.push(json!({ "mesh": 0 }));
    let mut gltf = Gltf::with_square();
    gltf.nodes(json!(nodes));
    assert_eq!(placed_corners(&import(&gltf)), square());
}

// ---- surfaces --------------------------------------------------------------------------------------------------

#[test]
fn bad_faces_are_dropped_and_counted_by_name() {
    let mut positions = SQUARE.to_vec();
    positions.push([0.5, 0., 0.]);
    let faces = [[0, 1, 2], [0, 2, 3], [0, 0, 1], [0, 4, 1], [1, 1, 1], [1, 2, 0], [2, 3, 0], [0, 3, 2]];
    let scene = import(&Gltf::of_triangles(&positions, faces.as_flattened()));
    let expected = "hall: dropped 3 faces without area and 2 duplicate faces";
    assert!(scene.notes.iter().any(|note| note == expected), "{:?}", scene.notes);
    assert_eq!(scene.parts[0].surfaces.len(), 2, "the square and half of its back are left");
}

/// Beside a corner at 1e30 m a square of 1 m is nothing, even in f64: no surface may be left without an area.
#[test]
fn what_vanishes_beside_a_huge_face_is_dropped() {
    let huge = [[-1e30, 0., 0.], [1e30, 0., 0.], [0., 1e30, 0.]];
    let scene =
        import(&Gltf::of_triangles(&[SQUARE.as_slice(), &huge].concat(), &[0, 1, 2, 0, 2, 3, 4, 5, 6]));
    let areas = scene.parts[0].surfaces.iter().map(|s| s.corners.double_area_vector().length() / 2.0);
    assert_eq!(areas.map(|area| area > 1.0).collect::<Vec<_>>(), [true]);
    assert!(noted(&scene, "hall: dropped 1 face without area"), "{:?}", scene.notes);
}

#[test]
fn two_nodes_in_one_place_make_one_surface() {
    let mut gltf = Gltf::with_square();
    gltf.nodes(json!([{ "name": "hall", "mesh": 0, "children": [1, 2] }, { "mesh": 0 }, { "mesh": 0, "scale": [1, 0, 1] }]));
    let scene = import(&gltf);
    assert_eq!(placed_corners(&scene), square());
    assert!(noted(&scene, "hall: dropped 1 face without area and 1 duplicate face"), "{:?}", scene.notes);
}

// ---- materials -------------------------------------------------------------------------------------------------

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

// ---- lights and cameras ----------------------------------------------------------------------------------------

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

// ---- extras ----------------------------------------------------------------------------------------------------

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

#[test]
fn the_default_scene_decides_and_no_scene_means_all_roots() {
    let mut gltf = Gltf::with_square();
    gltf.nodes(json!([
        { "name": "a", "mesh": 0 },
        { "name": "b", "mesh": 0, "translation": [0, 0, 1], "children": [0] },
        { "name": "c", "mesh": 0, "translation": [0, 0, 2] },
    ]));
    for (scenes, default, expected) in [
        (json!([]), Value::Null, "b c"),
        (json!([{ "nodes": [2] }, { "nodes": [0, 2] }]), Value::Null, "c"),
        (json!([{ "nodes": [2] }, { "nodes": [0, 2] }]), json!(1), "a c"),
    ] {
        gltf = gltf.set("/scenes", scenes).set("/scene", default);
        let scene = import(&gltf);
        let names = scene.instances.iter().map(|i| i.name.as_str()).collect::<Vec<_>>().join(" ");
        assert_eq!(names, expected);
    }
}

// ---- refusals --------------------------------------------------------------------------------------------------

/// Imports `file`, which must be refused with a message that names `culprit` and holds `words`.
fn refused(case: &str, file: &Path, culprit: &str, words: &str) {
    match import_scene(file) {
        Ok(scene) => panic!("{case}: accepted, with the notes {:?}", scene.notes),
        Err(error) => {
            let message = error.to_string();
            assert!(message.contains(culprit), "{case}: '{message}' does not name {culprit}");
            assert!(message.contains(words), "{case}: '{message}' does not say '{words}'");
        }
    }
}

#[test]
fn contradictory_files_are_refused_by_name() {
    let square = || Gltf::square_at(json!({ "name": "hall" }));
    let node = |node: Value| {
        let mut gltf = Gltf::with_square();
        gltf.nodes(json!([node, { "name": "door", "mesh": 0 }]));
        gltf
    };
    let extras = |extras: Value| square().set("/nodes/0/extras", extras);
    let nodes = |nodes: Value, roots: Value| {
        let mut gltf = Gltf::with_square().set("/scenes", json!([{ "nodes": roots }]));
        gltf.nodes(nodes);
        gltf
    };
    let factor = |pointer: &str, value: Value| square().set(pointer, value);
    let positions = |positions: &[[f32; 3]]| Gltf::of_triangles(positions, &HALVES);
    let (mut nan, mut infinite) = (SQUARE, SQUARE);
    (nan[3][1], infinite[2][0]) = (f32::NAN, f32::INFINITY);
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
    let sparse = |index: u8| {
        let mut gltf = square();
        let (at, values) = (gltf.view(&[index]), gltf.view(&[0; 12]));
        let indices = json!({ "bufferView": at, "componentType": U8 });
        gltf.json["accessors"][0]["sparse"] =
            json!({ "count": 1, "indices": indices, "values": { "bufferView": values } });
        gltf
    };
    let mut endless = Gltf::with_square();
    endless.json["accessors"][0] = json!({
        "componentType": F32, "type": "VEC3", "count": 1_u64 << 60,
        "sparse": { "count": 1, "indices": { "bufferView": 1, "componentType": U8 }, "values": { "bufferView": 0 } },
    });
    endless.nodes(json!([{ "mesh": 0 }]));
    for (words, gltf) in [
        // accessors
        ("4 elements reach past", square().set("/bufferViews/0/byteLength", json!(40))),
        ("1000000 elements reach past", square().set("/accessors/0/count", json!(1_000_000))),
        ("elements reach past", square().set("/accessors/0/byteOffset", json!(u64::MAX))),
        ("reaches past its buffer", square().set("/bufferViews/0/byteOffset", json!(9999))),
        ("reaches past its buffer", square().set("/bufferViews/0/byteOffset", json!(u64::MAX))),
        ("stride of 4 bytes", square().set("/bufferViews/0/byteStride", json!(4))),
        ("at most 67108864 elements", endless),
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
        // hierarchy
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
        // materials
        ("rho [1.5", factor("/materials/0/pbrMetallicRoughness/baseColorFactor", json!([1.5, 0, 0, 1]))),
        (
            "rho [0.0, -0.5",
            factor("/materials/0/pbrMetallicRoughness/baseColorFactor", json!([0, -0.5, 0, 1])),
        ),
        ("material grey with the radiance", factor("/materials/0/emissiveFactor", json!([0, -1, 0]))),
        ("material grey with the radiance", factor("/materials/0/emissiveFactor", json!([0, 1e39, 0]))),
        // lights and cameras
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
        // extras
        ("node hall with element_size = 0", extras(json!({ "element_size": 0 }))),
        ("node hall with element_size = \"1\"", extras(json!({ "element_size": "1" }))),
        ("node hall with emission_scale = -1", extras(json!({ "emission_scale": -1 }))),
        ("node hall with local_solver = \"magic\"", extras(json!({ "local_solver": "magic" }))),
        ("node hall with part = 7", extras(json!({ "part": 7 }))),
        // files
        ("URL", extras(json!({ "part": "https://example.org/lamp.glb" }))),
        ("URL or an absolute path", extras(json!({ "part": "C:\\lamp.glb" }))),
        ("absolute path", extras(json!({ "part": "/etc/lamp.glb" }))),
        ("leaves the scene's folder", extras(json!({ "part": "parts/../../lamp.glb" }))),
        ("lamp.glb cannot be read", extras(json!({ "part": "lamp.glb" }))),
        ("cycle of part files: scene.glb → scene.glb", extras(json!({ "part": "scene.glb" }))),
        // what is no scene
        ("no surfaces", square().set("/nodes", json!([]))),
        ("no surfaces", square().set("/nodes/0/scale", json!([0, 0, 0]))),
        (
            "requires the extension KHR_texture_basisu",
            square().set("/extensionsRequired", json!(["KHR_texture_basisu"])),
        ),
        ("asset.version is '1.0'", square().set("/asset/version", json!("1.0"))),
        ("asset.minVersion is '2.1'", square().set("/asset/minVersion", json!("2.1"))),
        ("no surfaces", node(json!({})).set("/nodes/1", json!({ "name": "empty" }))),
    ] {
        let folder = Folder::new();
        refused(words, &folder.write("scene.glb", gltf.glb()), "scene.glb", words);
    }
}

#[test]
fn damaged_containers_are_refused_by_name() {
    let gltf = Gltf::square_at(json!({}));
    let whole = gltf.glb();
    let text = gltf.text(None);
    let edited = |from: &str, to: &str| String::from_utf8_lossy(&text).replace(from, to).into_bytes();
    let with_length = |length: u32| [&whole[..8], &length.to_le_bytes(), &whole[12..]].concat();
    let buffer = |buffer: Value| {
        let mut json = gltf.json.clone();
        json["buffers"] = json!([buffer]);
        json.to_string().into_bytes()
    };
    for (case, name, bytes, words) in [
        ("empty", "scene.glb", Vec::new(), "not glTF"),
        ("a picture", "scene.glb", b"\x89PNG\r\n\x1a\n".to_vec(), "not glTF"),
        ("half a header", "scene.glb", whole[..7].to_vec(), "truncated"),
        ("half a file", "scene.glb", whole[..whole.len() / 2].to_vec(), "truncated"),
        ("a length of nothing", "scene.glb", with_length(0), "truncated"),
        ("a length of 20", "scene.glb", container(b"", b""), "not glTF"),
        ("version 1", "scene.glb", [&whole[..4], &[1, 0, 0, 0], &whole[8..]].concat(), "version"),
        ("half a text", "scene.gltf", text[..text.len() / 2].to_vec(), "EOF"),
        ("broken base64", "scene.gltf", edited("base64,", "base64,?"), "base64"),
        (
            "no data",
            "scene.gltf",
            edited("application/octet-stream;base64,", ""),
            "data URI that is malformed",
        ),
        ("long buffer", "scene.gltf", edited("\"byteLength\":72", "\"byteLength\":1000"), "byteLength"),
        ("no buffer", "scene.gltf", buffer(json!({ "byteLength": 72 })), "without uri"),
        ("missing buffer", "scene.gltf", buffer(json!({ "byteLength": 72, "uri": "no.bin" })), "no.bin"),
        (
            "foreign buffer",
            "scene.gltf",
            buffer(json!({ "byteLength": 72, "uri": "%2E%2E/no.bin" })),
            "leaves",
        ),
        (
            "remote buffer",
            "scene.gltf",
            buffer(json!({ "byteLength": 72, "uri": "http://localhost/no.bin" })),
            "URL",
        ),
    ] {
        let folder = Folder::new();
        refused(case, &folder.write(name, bytes), name, words);
    }
    let folder = Folder::new();
    refused("missing", &folder.0.path().join("nowhere.glb"), "nowhere.glb", "cannot be read");
    refused("no such folder", &folder.0.path().join("no/where.glb"), "where.glb", "cannot be read");
    refused("a folder", folder.0.path(), &folder.0.path().display().to_string(), "a folder without");
}

/// No prefix of a valid file crashes the importer, and none but the whole is accepted.
#[test]
fn every_truncation_is_refused() {
    let gltf = Gltf::square_at(json!({}));
    let folder = Folder::new();
    for (name, bytes) in [("scene.glb", gltf.glb()), ("scene.gltf", gltf.text(None))] {
        for end in 0..bytes.len() {
            refused(&format!("{end} bytes of {name}"), &folder.write(name, &bytes[..end]), name, "not glTF");
        }
    }
}

#[test]
fn faults_in_part_files_are_refused_in_their_name() {
    let referring = |part: &str| Gltf::square_at(json!({ "extras": { "part": part } })).glb();
    let folder = Folder::new();
    folder.write("a.glb", referring("b.glb"));
    folder.write("b.glb", referring("a.glb"));
    folder.write("empty.glb", Gltf::with_square().glb());
    folder.write("broken.glb", b"glTF");
    (0..20)
        .for_each(|i| drop(folder.write(&format!("deep{i}.glb"), referring(&format!("deep{}.glb", i + 1)))));
    for (part, culprit, words) in [
        ("a.glb", "b.glb", "scene.glb → a.glb → b.glb → a.glb"),
        ("empty.glb", "empty.glb", "no surfaces"),
        ("broken.glb", "broken.glb", "truncated"),
        ("deep0.glb", "deep15.glb", "long chain"),
    ] {
        refused(part, &folder.write("scene.glb", referring(part)), culprit, words);
    }
}

#[cfg(unix)]
#[test]
fn a_link_out_of_the_folder_is_refused() {
    let (folder, outside) = (Folder::new(), Folder::new());
    let target = outside.write("lamp.glb", Gltf::square_at(json!({})).glb());
    std::os::unix::fs::symlink(target, folder.0.path().join("lamp.glb")).expect("a link");
    let scene = Gltf::square_at(json!({ "extras": { "part": "lamp.glb" } }));
    refused(
        "a link",
        &folder.write("scene.glb", scene.glb()),
        "scene.glb",
        "leaves the scene's folder by a link",
    );
}
