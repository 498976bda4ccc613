//! Writes glTF files for tests: each node has a part, a position and extras.

use equilux_formats::{Material, MaterialId, Part, Rgb, Surface, glb};
use glam::DVec3;
use serde_json::{Value, json};
use std::f64::consts::PI;
use std::path::Path;

/// A root node of a scene.
#[derive(Debug, Clone)]
pub struct Node {
    /// Its name.
    pub name: String,
    /// Its part; none if the extras name a part file.
    pub part: Option<Part>,
    /// Position of its origin, metres.
    pub at: DVec3,
    /// Its extras.
    pub extras: Value,
}

impl Node {
    /// A node with `part` at the origin.
    pub fn new(name: &str, part: Part) -> Self {
        Self { name: name.into(), part: Some(part), at: DVec3::ZERO, extras: json!({}) }
    }

    /// A node with the contents of another file.
    pub fn of_file(name: &str, file: &str) -> Self {
        Self { name: name.into(), part: None, at: DVec3::ZERO, extras: json!({ "part": file }) }
    }

    /// The same node with a local solver in its extras.
    pub fn solved_by(mut self, solver: &str) -> Self {
        self.extras["local_solver"] = json!(solver);
        self
    }
}

/// A glTF file in memory, which tests may change.
#[derive(Debug, Clone)]
pub struct Model {
    /// The JSON.
    pub json: Value,
    /// The only buffer.
    pub binary: Vec<u8>,
}

impl Model {
    /// A scene of these nodes, one primitive for each material of each.
    pub fn of(nodes: &[Node]) -> Self {
        let json = json!({
            "asset": { "version": "2.0" },
            "extensionsUsed": ["KHR_materials_emissive_strength"],
            "scenes": [{ "nodes": (0..nodes.len()).collect::<Vec<_>>() }],
            "nodes": [], "meshes": [], "materials": [], "accessors": [], "bufferViews": [], "buffers": [{}],
        });
        let mut model = Self { json, binary: vec![] };
        nodes.iter().for_each(|node| model.add(node));
        model.json["buffers"][0]["byteLength"] = json!(model.binary.len());
        model
    }

    /// Replaces the value at `pointer` in the JSON.
    pub fn with(mut self, pointer: &str, value: Value) -> Self {
        let (parent, key) = pointer.rsplit_once('/').expect("a pointer with a slash");
        let parent = self.json.pointer_mut(parent).expect("the parent is there");
        match key.parse::<usize>() {
            Ok(index) => parent[index] = value,
            Err(_) => parent[key] = value,
        }
        self
    }

    /// Adds an accessor on these bytes, and returns its number.
    pub fn add_accessor(&mut self, bytes: &[u8], mut accessor: Value) -> usize {
        self.binary.resize(self.binary.len().next_multiple_of(4), 0);
        let view = json!({ "buffer": 0, "byteOffset": self.binary.len(), "byteLength": bytes.len() });
        self.binary.extend(bytes);
        self.json["buffers"][0]["byteLength"] = json!(self.binary.len());
        accessor["bufferView"] = json!(self.push("bufferViews", view));
        self.push("accessors", accessor)
    }

    /// The bytes of the `.glb` file.
    pub fn bytes(&self) -> Vec<u8> {
        glb::file(self.json.to_string().as_bytes(), &self.binary).expect("a file of less than 4 GiB")
    }

    /// Writes the `.glb` file.
    pub fn write(&self, path: &Path) {
        std::fs::write(path, self.bytes()).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    }

    fn add(&mut self, node: &Node) {
        let mut json = json!({ "name": node.name, "translation": node.at.to_array(), "extras": node.extras });
        if let Some(part) = &node.part {
            let primitives: Vec<Value> =
                (0..part.materials.len()).map(|m| self.primitive(part, MaterialId::from_index(m))).collect();
            json["mesh"] = json!(self.push("meshes", json!({ "primitives": primitives })));
        }
        self.push("nodes", json);
    }

    fn primitive(&mut self, part: &Part, material: MaterialId) -> Value {
        let surfaces = part.surfaces.iter().filter(|surface| surface.material == material);
        let corners = surfaces.flat_map(|surface| {
            let c = surface.corners.as_slice();
            (1..c.len() - 1).flat_map(|i| [c[0], c[i], c[i + 1]]).collect::<Vec<_>>()
        });
        let (offset, mut count) = (self.binary.len(), 0);
        for corner in corners {
            corner.as_vec3().to_array().iter().for_each(|x| self.binary.extend(x.to_le_bytes()));
            count += 1;
        }
        let length = self.binary.len() - offset;
        let view =
            self.push("bufferViews", json!({ "buffer": 0, "byteOffset": offset, "byteLength": length }));
        // The importer does not need minimum and maximum, which glTF requires for positions.
        let accessor = json!({ "bufferView": view, "componentType": 5126, "type": "VEC3", "count": count,
            "min": [0, 0, 0], "max": [0, 0, 0] });
        let positions = self.push("accessors", accessor);
        let mut attributes = json!({ "POSITION": positions });
        if let Some(places) = places(part, material) {
            let view = json!({ "buffer": 0, "byteOffset": self.binary.len(), "byteLength": 8 * count });
            places.iter().for_each(|x| self.binary.extend(x.to_le_bytes()));
            let view = self.push("bufferViews", view);
            let accessor =
                json!({ "bufferView": view, "componentType": 5126, "type": "VEC2", "count": count });
            let accessor = json!(self.push("accessors", accessor));
            // glTF requires a first set before the second.
            (attributes["TEXCOORD_0"], attributes["TEXCOORD_1"]) = (accessor.clone(), accessor);
        }
        let material = self.push("materials", gltf_material(&part.materials[material.index()]));
        json!({ "attributes": attributes, "material": material })
    }

    fn push(&mut self, list: &str, value: Value) -> usize {
        let list = self.json[list].as_array_mut().expect("a list");
        list.push(value);
        list.len() - 1
    }
}

/// Where the corners of a material's triangles lie in the part's lightmap, two numbers each, if all surfaces do.
fn places(part: &Part, material: MaterialId) -> Option<Vec<f32>> {
    let surfaces = part.surfaces.iter().filter(|surface| surface.material == material);
    let of_surface = |surface: &Surface| {
        let (places, count) = (surface.lightmap?, surface.corners.as_slice().len());
        let triangles = (1..count - 1).flat_map(move |i| [places[0], places[i], places[i + 1]]);
        Some(triangles.flat_map(|place| place.as_vec2().to_array()).collect::<Vec<_>>())
    };
    surfaces.map(of_surface).collect::<Option<Vec<_>>>().map(|all| all.concat())
}

fn gltf_material(material: &Material) -> Value {
    let radiance = material.emission.map(|e| e / PI);
    // glTF requires emissive factors in 0..1, and a separate strength.
    let strength = radiance.iter().fold(1.0, |most: f64, &l| most.max(l));
    let Rgb([r, g, b]) = material.reflectance;
    json!({
        "name": material.name,
        "pbrMetallicRoughness": { "baseColorFactor": [r, g, b, 1.0], "metallicFactor": 0.0 },
        "emissiveFactor": radiance / strength,
        "extensions": { "KHR_materials_emissive_strength": { "emissiveStrength": strength } },
        "doubleSided": material.double_sided,
    })
}
