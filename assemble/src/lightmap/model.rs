//! The scene as a model that carries its lightmap. Input: a lightmap and its images. Output: a binary glTF 2.0 file
//! with a node for each instance, whose mesh shares its vertices with the other instances of its part and scale.
//!
//! Each node has its own materials, since its light is its own: the image is their texture, and KHR_texture_transform
//! maps the shared texture coordinates to the node's rectangle. glTF requires TEXCOORD_0 before TEXCOORD_1, so both
//! are equal.

use super::Lightmap;
use super::images::Peaks;
use super::listing::rectangles;
use crate::origin_node::under_origin;
use equilux_formats::{Material, MaterialId, Rgb, glb};
use glam::{DVec3, UVec2, Vec2, Vec3};
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::f64::consts::PI;
use std::io;

/// Bytes of a vertex: POSITION and TEXCOORD_1, three and two f32.
const VERTEX_BYTES: usize = 20;
const FLOAT: u32 = 5126;
const ARRAY_BUFFER: u32 = 34962;

/// The contents of the model's textures.
pub enum ModelLook<'a> {
    /// Radiosity as a share of its peak, used as emission in units of radiance. Base colours are kept.
    Emissive(&'a Peaks),
    /// The colours of the pictures, used for unlit surfaces.
    Unlit,
}

/// The bytes of the model file. `images`: PNG files.
pub fn model(lightmap: &Lightmap, images: &[Vec<u8>], look: &ModelLook) -> io::Result<Vec<u8>> {
    let mut document = ModelDocument::default();
    let meshes: Vec<Vec<ModelPrimitive>> =
        (0..lightmap.atlas.layouts.len()).map(|layout| document.add_vertices(lightmap, layout)).collect();
    for (number, instance) in lightmap.scene.instances.iter().enumerate() {
        let primitives = &meshes[lightmap.atlas.instances[number].layout];
        if !primitives.is_empty() {
            let mesh = document.add_mesh(lightmap, number, primitives, look);
            document.nodes.push(json!({
                "name": instance.name, "mesh": mesh, "matrix": matrix(instance.placement),
            }));
        }
    }
    let bin = document.add_images(images);
    let json = document.json(lightmap.scene.origin, bin.len(), images.len(), look).to_string();
    glb::file(json.as_bytes(), &bin)
}

fn matrix(placement: glam::DAffine3) -> [f64; 16] {
    glam::DMat4::from(placement).to_cols_array()
}

/// Triangles of one material on one sheet, or without texels.
struct ModelPrimitive {
    material: MaterialId,
    positions: usize,
    /// The sheet, and the accessor of coordinates on it.
    texels: Option<(usize, usize)>,
}

/// The triangles of one primitive: their material, and the image of their texels, if they have any.
type Group = (MaterialId, Option<usize>);

/// A corner, and its place in the image.
type Vertex = (Vec3, Vec2);

#[derive(Default)]
struct ModelDocument {
    vertices: Vec<u8>,
    accessors: Vec<Value>,
    views: Vec<Value>,
    nodes: Vec<Value>,
    meshes: Vec<Value>,
    materials: Vec<Value>,
}

impl ModelDocument {
    /// The triangles of a layout.
    fn add_vertices(&mut self, lightmap: &Lightmap, layout: usize) -> Vec<ModelPrimitive> {
        let layout = &lightmap.atlas.layouts[layout];
        let mut groups: BTreeMap<Group, Vec<Vertex>> = BTreeMap::new();
        for ((chart, grid), spot) in layout.charts.iter().zip(&layout.grids).zip(&layout.spots) {
            let group = groups.entry((chart.material, Some(spot.image))).or_default();
            let size = UVec2::from(layout.sheets[spot.image]) - 2 * layout.border;
            let first = UVec2::from(spot.at).as_dvec2() - f64::from(layout.border);
            for (side, &plane) in chart.sides.iter().zip(&chart.planes) {
                let coordinates = |p: DVec3| ((grid.texel_of(plane, p) + first) / size.as_dvec2()).as_vec2();
                group.extend(triangles(side.corners.as_slice()).map(|p| (p.as_vec3(), coordinates(p))));
            }
        }
        for side in &layout.without_texels {
            let corners = triangles(side.corners.as_slice()).map(|p| (p.as_vec3(), Vec2::ZERO));
            groups.entry((side.material, None)).or_default().extend(corners);
        }
        let primitive = |((material, sheet), vertices): (Group, Vec<Vertex>)| {
            let positions = self.add_accessors(&vertices, sheet.is_some());
            ModelPrimitive { material, positions, texels: sheet.map(|sheet| (sheet, positions + 1)) }
        };
        groups.into_iter().map(primitive).collect()
    }

    /// Adds the accessor of positions, and after it that of coordinates if there are any; returns the first.
    fn add_accessors(&mut self, vertices: &[Vertex], with_coordinates: bool) -> usize {
        let (start, first) = (self.vertices.len(), self.accessors.len());
        let bound = |start: Vec3, pick: fn(Vec3, Vec3) -> Vec3| {
            vertices.iter().map(|v| v.0).fold(start, pick).to_array()
        };
        self.accessors.push(json!({
            "bufferView": 0, "byteOffset": start, "componentType": FLOAT, "count": vertices.len(), "type": "VEC3",
            "min": bound(Vec3::INFINITY, Vec3::min), "max": bound(Vec3::NEG_INFINITY, Vec3::max),
        }));
        if with_coordinates {
            self.accessors.push(json!({
                "bufferView": 0, "byteOffset": start + 12, "componentType": FLOAT, "count": vertices.len(), "type": "VEC2",
            }));
        }
        for (position, coordinate) in vertices {
            let numbers = position.to_array().into_iter().chain(coordinate.to_array());
            self.vertices.extend(numbers.flat_map(f32::to_le_bytes));
        }
        first
    }

    /// Add the mesh of an instance, with materials of its own, and return its index.
    fn add_mesh(
        &mut self,
        lightmap: &Lightmap,
        instance: usize,
        primitives: &[ModelPrimitive],
        look: &ModelLook,
    ) -> usize {
        let primitive = |p: &ModelPrimitive| {
            self.materials.push(material(lightmap, instance, p, look));
            let attributes = match p.texels {
                Some((_, at)) => json!({ "POSITION": p.positions, "TEXCOORD_0": at, "TEXCOORD_1": at }),
                None => json!({ "POSITION": p.positions }),
            };
            json!({ "attributes": attributes, "material": self.materials.len() - 1 })
        };
        let primitives: Vec<Value> = primitives.iter().map(primitive).collect();
        let part = lightmap.scene.instances[instance].part.index();
        self.meshes.push(json!({ "name": lightmap.scene.parts[part].name, "primitives": primitives }));
        self.meshes.len() - 1
    }

    /// Append the images to the vertices in one buffer, add their buffer views, and return the buffer.
    fn add_images(&mut self, images: &[Vec<u8>]) -> Vec<u8> {
        let mut buffer = std::mem::take(&mut self.vertices);
        self.views.push(json!({
            "buffer": 0, "byteLength": buffer.len(), "byteStride": VERTEX_BYTES, "target": ARRAY_BUFFER,
        }));
        for image in images {
            self.views.push(json!({ "buffer": 0, "byteOffset": buffer.len(), "byteLength": image.len() }));
            buffer.extend(image);
            buffer.resize(buffer.len().next_multiple_of(4), 0);
        }
        buffer
    }

    fn json(mut self, origin: DVec3, bytes: usize, images: usize, look: &ModelLook) -> Value {
        let own = match look {
            ModelLook::Emissive(_) => "KHR_materials_emissive_strength",
            ModelLook::Unlit => "KHR_materials_unlit",
        };
        json!({
            "asset": { "version": "2.0", "generator": "Equilux" },
            "extensionsUsed": ["KHR_texture_transform", own],
            "scene": 0,
            "scenes": [{ "nodes": under_origin(&mut self.nodes, origin) }],
            "nodes": self.nodes,
            "meshes": self.meshes,
            "materials": self.materials,
            "textures": (0..images).map(|image| json!({ "source": image, "sampler": 0 })).collect::<Vec<_>>(),
            "images": (0..images).map(|image| json!({ "bufferView": image + 1, "mimeType": "image/png" })).collect::<Vec<_>>(),
            // Linear filtering without mipmaps, which would mix charts.
            "samplers": [{ "magFilter": 9729, "minFilter": 9729, "wrapS": 33071, "wrapT": 33071 }],
            "accessors": self.accessors,
            "bufferViews": self.views,
            "buffers": [{ "byteLength": bytes }],
        })
    }
}

fn material(lightmap: &Lightmap, instance: usize, primitive: &ModelPrimitive, look: &ModelLook) -> Value {
    let source = &lightmap.materials_of(instance)[primitive.material.index()];
    let Some((sheet, _)) = primitive.texels else { return plain(source, look) };
    let rectangle = &rectangles(lightmap, instance)[sheet];
    let texture = json!({
        "index": rectangle.image, "texCoord": 1,
        "extensions": { "KHR_texture_transform": { "offset": rectangle.offset, "scale": rectangle.scale } },
    });
    match look {
        ModelLook::Emissive(peaks) => json!({
            "name": source.name,
            "pbrMetallicRoughness": {
                "baseColorFactor": opaque(source.reflectance), "metallicFactor": 0.0, "roughnessFactor": 1.0,
            },
            "emissiveFactor": [1.0, 1.0, 1.0],
            "emissiveTexture": texture,
            "extensions": {
                "KHR_materials_emissive_strength": { "emissiveStrength": peaks[&(instance, primitive.material)] / PI },
            },
        }),
        ModelLook::Unlit => json!({
            "name": source.name,
            "pbrMetallicRoughness": { "baseColorTexture": texture, "metallicFactor": 0.0, "roughnessFactor": 1.0 },
            "extensions": { "KHR_materials_unlit": {} },
        }),
    }
}

/// The material of a surface without texels.
fn plain(source: &Material, look: &ModelLook) -> Value {
    let peak = source.emission.iter().fold(0.0, |peak: f64, &e| peak.max(e));
    let colour = json!({
        "baseColorFactor": opaque(source.reflectance), "metallicFactor": 0.0, "roughnessFactor": 1.0,
    });
    match look {
        ModelLook::Emissive(_) if peak > 0.0 => json!({
            "name": source.name,
            "pbrMetallicRoughness": colour,
            "emissiveFactor": (source.emission / peak).0,
            "extensions": { "KHR_materials_emissive_strength": { "emissiveStrength": peak / PI } },
        }),
        ModelLook::Emissive(_) => json!({ "name": source.name, "pbrMetallicRoughness": colour }),
        ModelLook::Unlit => json!({
            "name": source.name, "pbrMetallicRoughness": colour, "extensions": { "KHR_materials_unlit": {} },
        }),
    }
}

fn opaque(Rgb([r, g, b]): Rgb) -> [f64; 4] {
    [r, g, b, 1.0]
}

/// The corners of a convex polygon's triangles.
fn triangles(corners: &[DVec3]) -> impl Iterator<Item = DVec3> {
    (2..corners.len()).flat_map(|i| [corners[0], corners[i - 1], corners[i]])
}
