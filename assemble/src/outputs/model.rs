//! The lit scene as a model for any glTF viewer. Input: a [`SceneLight`] and the exposure of the pictures. Output: a
//! binary glTF 2.0 file with a node for each instance. Its elements are triangles that share no vertices, unlit
//! (KHR_materials_unlit), with the colours of the pictures (COLOR_0, linear).

use crate::origin_node::under_origin;
use crate::output_file;
use crate::outputs::scene_light::SceneLight;
use crate::picture::exposure::Exposure;
use equilux_bake::geometry::aabb::Aabb;
use equilux_formats::{Element, Result, Rgb, glb};
use glam::{DVec3, Vec3};
use serde_json::{Value, json};
use std::path::Path;

/// Bytes of a vertex: POSITION and COLOR_0, three f32 each.
const VERTEX_BYTES: usize = 24;
const FLOAT: u32 = 5126;
const ARRAY_BUFFER: u32 = 34962;

/// Write the lit scene, which has at least one element, to `path`. Fails if it cannot be written.
pub fn write(path: &Path, light: &SceneLight, exposure: Exposure) -> Result<()> {
    let (document, vertices) = model(light, exposure);
    output_file::write(path, |out| glb::write(out, document.to_string().as_bytes(), &vertices))
}

/// The JSON and the binary chunk.
fn model(light: &SceneLight, exposure: Exposure) -> (Value, Vec<u8>) {
    let (mut vertices, mut nodes, mut meshes, mut accessors) = (vec![], vec![], vec![], vec![]);
    for instance in 0..light.world.instances() {
        let range = light.world.elements_of(instance);
        if range.is_empty() {
            continue;
        }
        let elements = &light.world.elements[range.clone()];
        let triangles = InstanceTriangles::new(elements, &light.radiosity[range], exposure);
        nodes.push(json!({
            "name": light.instance_names[instance], "mesh": meshes.len(), "translation": triangles.origin.to_array(),
        }));
        meshes.push(json!({
            "name": light.part_names[instance],
            "primitives": [{
                "attributes": { "POSITION": accessors.len(), "COLOR_0": accessors.len() + 1 }, "material": 0,
            }],
        }));
        accessors.extend(triangles.accessors(vertices.len()));
        triangles.append_to(&mut vertices);
    }
    let roots = under_origin(&mut nodes, light.origin);
    (document(nodes, roots, meshes, accessors, vertices.len()), vertices)
}

fn document(
    nodes: Vec<Value>,
    roots: Vec<usize>,
    meshes: Vec<Value>,
    accessors: Vec<Value>,
    bytes: usize,
) -> Value {
    json!({
        "asset": { "version": "2.0", "generator": "Equilux" },
        "extensionsUsed": ["KHR_materials_unlit"],
        "scene": 0,
        "scenes": [{ "nodes": roots }],
        "nodes": nodes,
        "meshes": meshes,
        "materials": [{
            "pbrMetallicRoughness": { "metallicFactor": 0.0, "roughnessFactor": 1.0 },
            "extensions": { "KHR_materials_unlit": {} },
        }],
        "accessors": accessors,
        "bufferViews": [{
            "buffer": 0, "byteLength": bytes, "byteStride": VERTEX_BYTES, "target": ARRAY_BUFFER,
        }],
        "buffers": [{ "byteLength": bytes }],
    })
}

/// The triangles of one instance.
struct InstanceTriangles {
    /// Translation of the node, metres, exact in f32. Positions are relative to it, so that they stay accurate far
    /// from the origin of the scene.
    origin: Vec3,
    /// Position and colour.
    vertices: Vec<[Vec3; 2]>,
}

impl InstanceTriangles {
    fn new(elements: &[Element], radiosity: &[Rgb], exposure: Exposure) -> Self {
        let around = Aabb::around(elements.iter().flat_map(|element| element.corners.as_slice()));
        let origin = around.low.as_vec3();
        let mut vertices = Vec::with_capacity(6 * elements.len());
        for (element, &b) in elements.iter().zip(radiosity) {
            let colour = DVec3::from(exposure.shown(b).0).as_vec3();
            vertices.extend(triangles(element).map(|p| [(p - origin.as_dvec3()).as_vec3(), colour]));
        }
        Self { origin, vertices }
    }

    /// The accessors of positions and colours, for vertices that begin at byte `start` of the buffer.
    fn accessors(&self, start: usize) -> [Value; 2] {
        let positions = || self.vertices.iter().map(|vertex| vertex[0]);
        let accessor = |offset: usize| {
            json!({
                "bufferView": 0, "byteOffset": offset, "componentType": FLOAT, "count": self.vertices.len(), "type": "VEC3",
            })
        };
        let (mut position, colour) = (accessor(start), accessor(start + VERTEX_BYTES / 2));
        position["min"] = json!(positions().fold(Vec3::INFINITY, Vec3::min).to_array());
        position["max"] = json!(positions().fold(Vec3::NEG_INFINITY, Vec3::max).to_array());
        [position, colour]
    }

    fn append_to(&self, bytes: &mut Vec<u8>) {
        let numbers = self.vertices.iter().flatten().flat_map(|vector| vector.to_array());
        bytes.extend(numbers.flat_map(f32::to_le_bytes));
    }
}

/// The corners of an element's one or two triangles, counter-clockwise from the front.
fn triangles(element: &Element) -> impl Iterator<Item = DVec3> {
    let corners = element.corners.as_slice();
    (2..corners.len()).flat_map(|i| [corners[0], corners[i - 1], corners[i]])
}
