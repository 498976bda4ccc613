//! Textures and vertex colours: reflectance and emission of textured elements.

mod files;
mod means;

use equilux_bake::elements::ElementSize;
use equilux_bake::gltf_import::import_scene;
use equilux_bake::oven::prepare::{Division, Prepared, RowMethod, prepare};
use equilux_bake::treecode::EXACT;
use equilux_formats::{Part, Rgb};
use equilux_tests::model::{Model, Node};
use equilux_tests::shapes::{grey, part, rectangle};
use equilux_tests::workshop::Workshop;
use glam::{DVec2, DVec3, Vec3};
use image::{Rgba, RgbaImage};
use serde_json::{Value, json};
use std::io::Cursor;

/// A wall of 3 × 2 m that looks along z.
fn wall(material: equilux_formats::Material) -> Part {
    rectangle(part(material), DVec3::ZERO, 3.0 * DVec3::X, 2.0 * DVec3::Y)
}

/// A white wall whose lower left corner is (0, 1) in texture coordinates and whose upper right corner is (1, 0).
fn papered() -> Model {
    with_coordinates(Model::of(&[Node::new("wall", wall(grey(1.0, 0.0)))]), |p| [p.x / 3.0, 1.0 - p.y / 2.0])
}

/// The model with TEXCOORD_0 in its first primitive.
fn with_coordinates(model: Model, at: impl Fn(Vec3) -> [f32; 2]) -> Model {
    with_attribute(model, "TEXCOORD_0", "VEC2", |p| at(p).to_vec())
}

/// The model with an attribute of floats in its first primitive.
fn with_attribute(mut model: Model, name: &str, kind: &str, at: impl Fn(Vec3) -> Vec<f32>) -> Model {
    let positions = &model.json["accessors"][0];
    let count = positions["count"].as_u64().expect("a count") as usize;
    let float = |bytes: &[u8]| f32::from_le_bytes(bytes.try_into().expect("4 bytes"));
    let values: Vec<f32> = model.binary[..12 * count].chunks_exact(4).map(float).collect();
    let values: Vec<f32> = values.chunks_exact(3).flat_map(|p| at(Vec3::from_slice(p))).collect();
    let (offset, length) = (model.binary.len(), 4 * values.len());
    model.binary.extend(values.iter().flat_map(|value| value.to_le_bytes()));
    let mut push = |list: &str, value: Value| {
        let list = model.json[list].as_array_mut().expect("a list");
        list.push(value);
        list.len() - 1
    };
    let view = push("bufferViews", json!({ "buffer": 0, "byteOffset": offset, "byteLength": length }));
    let accessor =
        push("accessors", json!({ "bufferView": view, "componentType": 5126, "type": kind, "count": count }));
    model.json["meshes"][0]["primitives"][0]["attributes"][name] = json!(accessor);
    model.json["buffers"][0]["byteLength"] = json!(model.binary.len());
    model
}

/// The model whose first material has the image at `uri` on its base colour or its emission.
fn with_image(mut model: Model, on: &str, uri: &str, sampler: Value, transform: Value) -> Model {
    let info = json!({ "index": 0, "extensions": { "KHR_texture_transform": transform } });
    *model.json.pointer_mut("/materials/0").expect("a material").pointer_mut(on).expect("a place") = info;
    model.json["images"] = json!([{ "uri": uri }]);
    model.json["samplers"] = json!([sampler]);
    model.json["textures"] = json!([{ "source": 0, "sampler": 0 }]);
    model
}

/// The papered wall with this image on its base colour.
fn wallpaper(uri: &str, transform: Value) -> Model {
    let mut model = papered();
    model.json["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"] = json!(null);
    with_image(model, "/pbrMetallicRoughness/baseColorTexture", uri, json!({}), transform)
}

/// A PNG file.
fn png(width: u32, height: u32, texel: impl Fn(u32, u32) -> [u8; 4]) -> Vec<u8> {
    let image = RgbaImage::from_fn(width, height, |x, y| Rgba(texel(x, y)));
    let mut bytes = Vec::new();
    image.write_to(&mut Cursor::new(&mut bytes), image::ImageFormat::Png).expect("a PNG file");
    bytes
}

/// The scene's parts with elements of this size.
fn prepared(workshop: &Workshop, element_size: ElementSize, division: Division) -> Prepared {
    let wanted = equilux_bake::oven::prepare::Preparation {
        element_size: Some(element_size),
        division,
        resolution: EXACT,
        rows: RowMethod::Exact,
        rays: 256,
        local_solver: None,
    };
    let scene = import_scene(&workshop.path("scene.glb")).unwrap_or_else(|error| panic!("{error}"));
    prepare(&scene, &wanted).expect("elements")
}

/// Averages over the area of all elements: reflectance and emission.
fn averages(prepared: &Prepared) -> [Rgb; 2] {
    let (mut area, mut sums) = (0.0, [Rgb::BLACK; 2]);
    for part in &prepared.parts {
        for (i, element) in part.geometry.elements.iter().enumerate() {
            area += element.area;
            for (sum, values) in sums.iter_mut().zip([&part.optics.reflectance, &part.optics.emission]) {
                *sum += values[i] * element.area;
            }
        }
    }
    sums.map(|sum| sum / area)
}

/// The reflectance of a wall in `workshop`, red.
fn reflectance(workshop: &Workshop) -> f64 {
    averages(&prepared(workshop, ElementSize::Mesh, Division::Authored))[0][0]
}

/// Linear light of an sRGB byte.
fn linear(byte: u8) -> f64 {
    let value = f64::from(byte) / 255.0;
    if value <= 0.04045 { value / 12.92 } else { ((value + 0.055) / 1.055).powf(2.4) }
}

/// A point in texture coordinates after offset, rotation and scale, as the extension's example has it.
fn transformed(place: DVec2, offset: DVec2, rotation: f64, scale: DVec2) -> DVec2 {
    let (place, (sin, cos)) = (place * scale, rotation.sin_cos());
    offset + DVec2::new(cos * place.x + sin * place.y, cos * place.y - sin * place.x)
}
