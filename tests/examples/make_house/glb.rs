//! A part as a binary glTF file: one mesh, a primitive a material, two triangles a rectangle.

use equilux_formats::{Material, Part, Rgb, Surface, glb};
use glam::{DVec3, Vec3};
use serde_json::{Value, json};
use std::f64::consts::PI;
use std::io::Result;
use std::path::Path;

const FLOAT: u32 = 5126;
const ARRAY_BUFFER: u32 = 34962;

/// Writes `part` to `path`.
pub fn write(path: &Path, part: &Part) -> Result<()> {
    let mut kinds: Vec<&Material> = Vec::new();
    let kind_of: Vec<usize> = part.materials.iter().map(|material| place(&mut kinds, material)).collect();
    let (mut bytes, mut accessors, mut primitives) = (Vec::new(), Vec::new(), Vec::new());
    for kind in 0..kinds.len() {
        let own = part.surfaces.iter().filter(|s| kind_of[s.material.index()] == kind);
        let corners: Vec<Vec3> = own.flat_map(triangles).map(|p| p.as_vec3()).collect();
        primitives.push(json!({ "attributes": { "POSITION": accessors.len() }, "material": kind }));
        accessors.push(accessor(bytes.len(), &corners));
        bytes.extend(corners.iter().flat_map(|p| p.to_array()).flat_map(f32::to_le_bytes));
    }
    let document = json!({
        "asset": { "version": "2.0" },
        "extensionsUsed": ["KHR_materials_emissive_strength"],
        "scene": 0,
        "scenes": [{ "nodes": [0] }],
        "nodes": [{ "name": part.name, "mesh": 0, "extras": extras(part) }],
        "meshes": [{ "name": part.name, "primitives": primitives }],
        "materials": kinds.iter().map(|material| material_json(material)).collect::<Vec<_>>(),
        "accessors": accessors,
        "bufferViews": [{ "buffer": 0, "byteLength": bytes.len(), "target": ARRAY_BUFFER }],
        "buffers": [{ "byteLength": bytes.len() }],
    });
    std::fs::write(path, glb::file(document.to_string().as_bytes(), &bytes)?)
}

/// Where `material` is among the `known` ones, added if it is new.
fn place<'a>(known: &mut Vec<&'a Material>, material: &'a Material) -> usize {
    known.iter().position(|k| *k == material).unwrap_or_else(|| {
        known.push(material);
        known.len() - 1
    })
}

fn triangles(surface: &Surface) -> impl Iterator<Item = DVec3> {
    let corners = surface.corners.as_slice();
    (2..corners.len()).flat_map(|i| [corners[0], corners[i - 1], corners[i]])
}

fn accessor(start: usize, corners: &[Vec3]) -> Value {
    let over =
        |pick: fn(Vec3, Vec3) -> Vec3| corners.iter().copied().reduce(pick).expect("corners").to_array();
    json!({
        "bufferView": 0, "byteOffset": start, "componentType": FLOAT, "count": corners.len(), "type": "VEC3",
        "min": over(Vec3::min), "max": over(Vec3::max),
    })
}

fn extras(part: &Part) -> Value {
    part.element_size.map_or(json!({}), |size| json!({ "element_size": size }))
}

/// Emission E = πL; glTF's strength carries what is above one.
fn material_json(material: &Material) -> Value {
    let Rgb([red, green, blue]) = material.reflectance;
    let radiance = material.emission.map(|e| e / PI);
    let strength = radiance.into_iter().fold(1.0, f64::max);
    let mut json = json!({
        "pbrMetallicRoughness": {
            "baseColorFactor": [red, green, blue, 1.0], "metallicFactor": 0.0, "roughnessFactor": 1.0,
        },
        "emissiveFactor": radiance / strength,
    });
    if strength > 1.0 {
        json["extensions"]["KHR_materials_emissive_strength"]["emissiveStrength"] = json!(strength);
    }
    json
}
