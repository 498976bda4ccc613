//! A writer of small glTF files, and helpers to read them.

use base64::Engine as _;
use base64::prelude::BASE64_STANDARD;
use equilux_bake::gltf_import::import_scene;
use equilux_formats::{Scene, glb};
use glam::DVec3;
use serde_json::{Value, json};
use std::fs;
use std::path::PathBuf;
use tempfile::TempDir;

pub const U8: u32 = 5121;
pub const U16: u32 = 5123;
pub const I16: u32 = 5122;
pub const U32: u32 = 5125;
pub const F32: u32 = 5126;

pub const SQUARE: [[f32; 3]; 4] = [[0., 0., 0.], [1., 0., 0.], [1., 1., 0.], [0., 1., 0.]];
pub const HALVES: [u32; 6] = [0, 1, 2, 0, 2, 3];

/// A glTF file under construction.
pub struct Gltf {
    pub json: Value,
    pub bytes: Vec<u8>,
}

impl Gltf {
    /// No nodes; mesh 0 is a unit square of two triangles in z = 0 with the grey material 0.
    pub fn with_square() -> Self {
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
    pub fn square_at(node: Value) -> Self {
        let mut gltf = Self::with_square();
        let mut node = node;
        node["mesh"] = json!(0);
        gltf.nodes(json!([node]));
        gltf
    }

    /// A mesh of these triangles at a node called `hall`, instead of the square.
    pub fn of_triangles(positions: &[[f32; 3]], indices: &[u32]) -> Self {
        let mut gltf = Self::square_at(json!({ "name": "hall" }));
        let (positions, indices) = (gltf.positions(positions), gltf.indices(indices));
        let primitive = json!({ "attributes": { "POSITION": positions }, "indices": indices, "material": 0 });
        gltf.json["meshes"] = json!([{ "name": "hall", "primitives": [primitive] }]);
        gltf
    }

    pub fn set(mut self, pointer: &str, value: Value) -> Self {
        let (parent, key) = pointer.rsplit_once('/').expect("a JSON pointer");
        let parent = self.json.pointer_mut(parent).unwrap_or_else(|| panic!("nothing at {parent}"));
        match parent {
            Value::Array(items) => items[key.parse::<usize>().expect("an index")] = value,
            other => other[key] = value,
        }
        self
    }

    pub fn push(&mut self, list: &str, value: Value) -> usize {
        if self.json[list].is_null() {
            self.json[list] = json!([]);
        }
        let list = self.json[list].as_array_mut().expect("a list");
        list.push(value);
        list.len() - 1
    }

    /// Nodes of which those that are no other's child are the scene's roots.
    pub fn nodes(&mut self, nodes: Value) {
        self.json["nodes"] = nodes;
    }

    pub fn view(&mut self, bytes: &[u8]) -> usize {
        self.bytes.resize(self.bytes.len().next_multiple_of(4), 0);
        let offset = self.bytes.len();
        self.bytes.extend_from_slice(bytes);
        self.push("bufferViews", json!({ "buffer": 0, "byteOffset": offset, "byteLength": bytes.len() }))
    }

    pub fn accessor(&mut self, bytes: &[u8], component: u32, kind: &str, count: usize) -> usize {
        let view = self.view(bytes);
        self.push(
            "accessors",
            json!({ "bufferView": view, "componentType": component, "type": kind, "count": count }),
        )
    }

    pub fn positions(&mut self, positions: &[[f32; 3]]) -> usize {
        let bytes: Vec<u8> = positions.iter().flatten().flat_map(|x| x.to_le_bytes()).collect();
        self.accessor(&bytes, F32, "VEC3", positions.len())
    }

    pub fn indices(&mut self, indices: &[u32]) -> usize {
        let bytes: Vec<u8> = indices.iter().flat_map(|i| i.to_le_bytes()).collect();
        self.accessor(&bytes, U32, "SCALAR", indices.len())
    }

    pub fn mesh(&mut self, name: &str, primitive: Value) -> usize {
        self.push("meshes", json!({ "name": name, "primitives": [primitive] }))
    }

    pub fn glb(&self) -> Vec<u8> {
        let mut json = self.json.clone();
        json["buffers"] = json!([{ "byteLength": self.bytes.len() }]);
        container(json.to_string().as_bytes(), &self.bytes)
    }

    /// A `.gltf` whose buffer lies at `uri`, or in the file.
    pub fn text(&self, uri: Option<&str>) -> Vec<u8> {
        let embedded =
            || format!("data:application/octet-stream;base64,{}", BASE64_STANDARD.encode(&self.bytes));
        let mut json = self.json.clone();
        json["buffers"] =
            json!([{ "byteLength": self.bytes.len(), "uri": uri.map_or_else(embedded, str::to_owned) }]);
        json.to_string().into_bytes()
    }
}

pub fn container(json: &[u8], binary: &[u8]) -> Vec<u8> {
    glb::file(json, binary).expect("a small file")
}

pub struct Folder(pub TempDir);

impl Folder {
    pub fn new() -> Self {
        Self(tempfile::tempdir().expect("a temporary folder"))
    }

    pub fn write(&self, name: &str, bytes: impl AsRef<[u8]>) -> PathBuf {
        let path = self.0.path().join(name);
        fs::create_dir_all(path.parent().expect("a folder")).expect("a folder");
        fs::write(&path, bytes).expect("a written file");
        path
    }
}

pub fn import(gltf: &Gltf) -> Scene {
    let folder = Folder::new();
    import_scene(&folder.write("scene.glb", gltf.glb())).unwrap_or_else(|error| panic!("{error}"))
}

/// Corners of all surfaces of all instances, in the scene.
pub fn placed_corners(scene: &Scene) -> Vec<Vec<DVec3>> {
    let surfaces = |instance: &equilux_formats::Instance| {
        let surfaces = scene.parts[instance.part.index()].surfaces.clone();
        let placement = instance.placement;
        surfaces
            .into_iter()
            .map(move |s| s.corners.as_slice().iter().map(|&p| placement.transform_point3(p)).collect())
    };
    scene.instances.iter().flat_map(surfaces).collect()
}

pub fn square() -> Vec<Vec<DVec3>> {
    vec![SQUARE.map(|corner| DVec3::from_array(corner.map(f64::from))).to_vec()]
}

pub fn noted(scene: &Scene, words: &str) -> bool {
    scene.notes.iter().any(|note| note.contains(words))
}
