//! A small scene and the legal forms that its file may take.

use base64::Engine as _;
use base64::prelude::BASE64_STANDARD;
use image::{ImageFormat, RgbImage};
use serde_json::{Value, json};
use std::io::Cursor;

/// A file of a form.
pub struct Form {
    pub name: String,
    pub bytes: Vec<u8>,
    /// The text of its note; none if it means exactly the same.
    pub note: Option<&'static str>,
}

/// The scene's only buffer: positions, indices, texture coordinates, an image.
pub struct Plain {
    pub json: Value,
    pub binary: Vec<u8>,
}

/// A square with a picture of one colour, a spot above it, a camera, and an animation, all without optional properties.
pub fn plain() -> Plain {
    let (corners, order) =
        ([[0.0_f32, 0., 0.], [1., 0., 0.], [1., 1., 0.], [0., 1., 0.]], [0_u16, 1, 2, 0, 2, 3]);
    let positions: Vec<u8> = corners.as_flattened().iter().flat_map(|x| x.to_le_bytes()).collect();
    let indices: Vec<u8> = order.iter().flat_map(|i| i.to_le_bytes()).collect();
    let places: Vec<u8> = corners.iter().flat_map(|c| [c[0], c[1]]).flat_map(f32::to_le_bytes).collect();
    let (mut binary, mut views) = (Vec::new(), Vec::new());
    for bytes in [positions, indices, places, picture(ImageFormat::Png, [255, 128, 64])] {
        views.push(json!({ "buffer": 0, "byteOffset": binary.len(), "byteLength": bytes.len() }));
        binary.extend(bytes);
        binary.resize(binary.len().next_multiple_of(4), 0);
    }
    let json = json!({
        "asset": { "version": "2.0" },
        "extensionsUsed": ["KHR_lights_punctual"],
        "extensions": { "KHR_lights_punctual": { "lights": [{ "type": "spot", "spot": {} }] } },
        "scenes": [{ "nodes": [0, 1, 2] }],
        "nodes": [
            { "name": "hall", "mesh": 0 },
            { "name": "lamp", "translation": [0, 0, 2], "extensions": { "KHR_lights_punctual": { "light": 0 } } },
            { "name": "eye", "camera": 0 },
        ],
        "cameras": [{ "type": "perspective", "perspective": { "yfov": 1, "znear": 0.5 } }],
        "meshes": [{ "name": "hall", "primitives": [
            { "attributes": { "POSITION": 0, "TEXCOORD_0": 2 }, "indices": 1, "material": 0 },
        ] }],
        "materials": [{ "name": "paper", "pbrMetallicRoughness": {
            "baseColorFactor": [0.5, 0.5, 0.5, 1], "metallicFactor": 0, "baseColorTexture": { "index": 0 },
        } }],
        "textures": [{ "source": 0 }],
        "images": [{ "name": "picture", "bufferView": 3, "mimeType": "image/png" }],
        "accessors": [
            { "bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3", "min": [0, 0, 0], "max": [1, 1, 0] },
            { "bufferView": 1, "componentType": 5123, "count": 6, "type": "SCALAR" },
            { "bufferView": 2, "componentType": 5126, "count": 4, "type": "VEC2" },
        ],
        "bufferViews": views,
    });
    Plain { json, binary }
}

/// A picture of one colour, 2 × 2 pixels, without loss.
pub fn picture(format: ImageFormat, colour: [u8; 3]) -> Vec<u8> {
    let mut bytes = Cursor::new(Vec::new());
    RgbImage::from_pixel(2, 2, image::Rgb(colour)).write_to(&mut bytes, format).expect("an encoded picture");
    bytes.into_inner()
}

impl Plain {
    /// The same with the JSON changed.
    pub fn edited(mut self, edit: impl FnOnce(&mut Value)) -> Self {
        edit(&mut self.json);
        self
    }

    /// A `.gltf` file whose buffer has the URI `uri`.
    pub fn text(&self, uri: &str) -> Vec<u8> {
        let mut json = self.json.clone();
        let buffers = json.as_object_mut().expect("an object").entry("buffers").or_insert_with(|| json!([]));
        let own = json!({ "byteLength": self.binary.len(), "uri": uri });
        buffers.as_array_mut().expect("a list").insert(0, own);
        json.to_string().into_bytes()
    }

    /// The buffer as a `data:` URI.
    pub fn base64(&self) -> String {
        format!("data:application/octet-stream;base64,{}", BASE64_STANDARD.encode(&self.binary))
    }

    /// Its first two chunks.
    fn chunks(&self) -> [Vec<u8>; 2] {
        let mut json = self.json.clone();
        json["buffers"] = json!([{ "byteLength": self.binary.len() }]);
        let mut json = json.to_string().into_bytes();
        json.resize(json.len().next_multiple_of(4), b' ');
        [chunk(b"JSON", &json), chunk(b"BIN\0", &self.binary)]
    }
}

fn chunk(kind: &[u8; 4], bytes: &[u8]) -> Vec<u8> {
    [&(bytes.len() as u32).to_le_bytes(), &kind[..], bytes].concat()
}

fn container(chunks: &[Vec<u8>]) -> Vec<u8> {
    let chunks = chunks.concat();
    [b"glTF", &2_u32.to_le_bytes()[..], &(12 + chunks.len() as u32).to_le_bytes(), &chunks].concat()
}

/// Adds `value` to the list at `pointer`.
pub fn push(json: &mut Value, pointer: &str, value: Value) {
    let list = json.pointer_mut(pointer).and_then(Value::as_array_mut);
    list.unwrap_or_else(|| panic!("no list at {pointer}")).push(value);
}

/// All forms. The first is the plainest.
pub fn forms() -> Vec<Form> {
    [containers(), uris(), json_forms(), left_out(), unused(), unknown()].into_iter().flatten().collect()
}

fn form(name: &str, bytes: Vec<u8>) -> Form {
    Form { name: name.to_owned(), bytes, note: None }
}

/// The plain scene with the JSON changed by `edit`.
fn edited(name: &str, note: Option<&'static str>, edit: impl FnOnce(&mut Value)) -> Form {
    let plain = plain().edited(edit);
    Form { name: format!("{name}.gltf"), bytes: plain.text(&plain.base64()), note }
}

fn containers() -> Vec<Form> {
    let [json, binary] = plain().chunks();
    let unknown = chunk(b"ABCD", b"1234");
    let whole = container(&[json.clone(), binary.clone()]);
    let embedded = plain().text(&plain().base64());
    let padded = {
        let mut text = embedded.clone();
        text.resize(text.len().next_multiple_of(4), b' ');
        text
    };
    let alone = container(&[chunk(b"JSON", &padded)]);
    vec![
        form("plain.gltf", embedded),
        form("container.glb", whole.clone()),
        form("bytes-after-the-end.glb", [&whole[..], b"more"].concat()),
        form("an-unknown-chunk.glb", container(&[json, binary, unknown.clone()])),
        form("no-binary-chunk.glb", alone.clone()),
        form("no-binary-chunk-and-bytes-after-the-end.glb", [&alone[..], b"more"].concat()),
        form("no-binary-chunk-but-an-unknown-one.glb", container(&[chunk(b"JSON", &padded), unknown])),
        form("an-empty-binary-chunk.glb", container(&[chunk(b"JSON", &padded), chunk(b"BIN\0", b"")])),
    ]
}

fn uris() -> Vec<Form> {
    let base64 = plain().base64();
    let (head, digits) = base64.split_once(',').expect("a comma");
    let escaped = digits.replace('+', "%2B").replace('/', "%2F").replace('=', "%3D");
    let percent: String = plain().binary.iter().map(|byte| format!("%{byte:02X}")).collect();
    [
        ("percent-encoded", format!("data:application/octet-stream,{percent}")),
        ("with-a-parameter", base64.replace(";base64", ";charset=utf-8;base64")),
        ("of-another-type", base64.replace("octet-stream", "gltf-buffer")),
        ("escaped-base64", format!("{head},{escaped}")),
        ("without-padding", base64.trim_end_matches('=').to_owned()),
    ]
    .into_iter()
    .map(|(name, uri)| form(&format!("{name}.gltf"), plain().text(&uri)))
    .collect()
}

/// Other ways to write the same values.
fn json_forms() -> Vec<Form> {
    vec![
        edited("integers-with-a-fraction", None, with_fractions),
        edited("a-default-scene", None, |json| json["scene"] = json!(0)),
        edited("a-later-minor-version", None, |json| {
            json["asset"] = json!({ "version": "2.1", "minVersion": "2.0", "generator": "by hand" });
        }),
        edited("extras-of-any-type", None, |json| {
            (json["extras"], json["nodes"][0]["extras"]) = (json!("text"), json!(5));
            json["meshes"][0]["extras"] = json!([1, null, { "a": true }]);
            json["extensions"]["KHR_lights_punctual"]["lights"][0]["extras"] = json!({ "watts": 5 });
        }),
        edited("specular-and-glossiness", None, |json| {
            json["extensionsUsed"] = json!(["KHR_lights_punctual", "KHR_materials_pbrSpecularGlossiness"]);
            json["extensionsRequired"] = json!(["KHR_materials_pbrSpecularGlossiness"]);
            json["materials"][0] = json!({ "name": "paper", "extensions": { "KHR_materials_pbrSpecularGlossiness": {
                "diffuseFactor": [0.5, 0.5, 0.5, 1], "diffuseTexture": { "index": 0 }, "specularFactor": [0, 0, 0],
            } } });
        }),
        edited(
            "specular-and-glossiness-with-a-fallback",
            Some("its specular reflection is ignored"),
            |json| {
                json["extensionsUsed"] =
                    json!(["KHR_lights_punctual", "KHR_materials_pbrSpecularGlossiness"]);
                json["materials"][0]["pbrMetallicRoughness"] = json!({ "baseColorFactor": [1, 0, 0, 1] });
                json["materials"][0]["extensions"] = json!({ "KHR_materials_pbrSpecularGlossiness": {
                "diffuseFactor": [0.5, 0.5, 0.5, 1], "diffuseTexture": { "index": 0 },
            } });
            },
        ),
        quantised("quantised-coordinates", false, 1),
        quantised("normalised-coordinates", true, i16::MAX),
    ]
}

/// Writes every integer as a number with a fraction of zero.
fn with_fractions(value: &mut Value) {
    match value {
        Value::Number(number) => *value = json!(number.as_f64()),
        Value::Array(items) => items.iter_mut().for_each(with_fractions),
        Value::Object(members) => members.values_mut().for_each(with_fractions),
        _ => {}
    }
}

/// Texture coordinates as 16-bit integers, of which `one` is 1, as KHR_mesh_quantization allows.
fn quantised(name: &str, normalized: bool, one: i16) -> Form {
    let mut plain = plain();
    let at = plain.json["bufferViews"][2]["byteOffset"].as_u64().expect("an offset") as usize;
    let places = [0, 0, one, 0, one, one, 0, one].map(i16::to_le_bytes);
    plain.binary[at..at + 16].copy_from_slice(places.as_flattened());
    (plain.json["bufferViews"][2]["byteStride"], plain.json["bufferViews"][2]["byteLength"]) =
        (json!(4), json!(16));
    (plain.json["accessors"][2]["componentType"], plain.json["accessors"][2]["normalized"]) =
        (json!(5122), json!(normalized));
    plain.json["extensionsUsed"] = json!(["KHR_lights_punctual", "KHR_mesh_quantization"]);
    plain.json["extensionsRequired"] = json!(["KHR_mesh_quantization"]);
    form(&format!("{name}.gltf"), plain.text(&plain.base64()))
}

/// Optional properties.
fn left_out() -> Vec<Form> {
    vec![
        edited("no-scenes", None, |json| drop(json.as_object_mut().expect("an object").remove("scenes"))),
        edited("a-scene-without-nodes", Some("several scenes"), |json| {
            push(json, "/scenes", json!({ "name": "empty" }))
        }),
        edited("an-unused-buffer-without-uri", None, |json| {
            json["buffers"] = json!([{ "byteLength": 4 }]);
            push(json, "/bufferViews", json!({ "buffer": 1, "byteLength": 4 }));
        }),
        edited("accessors-without-a-view", Some("2 faces without area"), |json| {
            let zeros = json!({ "componentType": 5126, "count": 6, "type": "VEC3", "min": [0, 0, 0], "max": [0, 0, 0] });
            push(json, "/accessors", zeros);
            push(json, "/accessors", json!({ "componentType": 5126, "count": 6, "type": "VEC2" }));
            let attributes = json!({ "POSITION": 3, "TEXCOORD_0": 4 });
            push(json, "/meshes/0/primitives", json!({ "attributes": attributes, "material": 0 }));
        }),
        edited("a-texture-without-source", Some("a texture without an image is ignored"), |json| {
            push(json, "/textures", json!({ "name": "nothing" }));
            json["materials"][0]["emissiveTexture"] = json!({ "index": 1 });
        }),
        edited(
            "a-texture-of-an-unknown-extension",
            Some("only image is one of KHR_texture_basisu"),
            |json| {
                json["extensionsUsed"] = json!(["KHR_lights_punctual", "KHR_texture_basisu"]);
                push(json, "/textures", json!({ "extensions": { "KHR_texture_basisu": { "source": 0 } } }));
                json["materials"][0]["emissiveTexture"] = json!({ "index": 1 });
            },
        ),
        edited("a-texture-with-an-empty-sampler", None, |json| {
            (json["samplers"], json["textures"][0]["sampler"]) = (json!([{}]), json!(0));
        }),
        edited("a-primitive-without-positions", Some("primitives without POSITION are ignored"), |json| {
            push(json, "/meshes/0/primitives", json!({ "attributes": { "TEXCOORD_0": 2 }, "indices": 1 }));
        }),
        edited("corners-left-over", Some("its last one or two corners make no triangle"), |json| {
            push(
                json,
                "/accessors",
                json!({ "bufferView": 1, "componentType": 5123, "count": 2, "type": "SCALAR" }),
            );
            let mut again = json["meshes"][0]["primitives"][0].clone();
            again["indices"] = json!(3);
            push(json, "/meshes/0/primitives", again);
        }),
    ]
}

/// Properties that do not affect static, diffuse light.
fn unused() -> Vec<Form> {
    let animation = |target: Value| {
        move |json: &mut Value| {
            for accessor in [
                json!({ "componentType": 5126, "count": 1, "type": "SCALAR", "min": [0], "max": [0] }),
                json!({ "componentType": 5126, "count": 1, "type": "VEC3" }),
            ] {
                push(json, "/accessors", accessor);
            }
            json["animations"] = json!([{
                "channels": [{ "sampler": 0, "target": target }], "samplers": [{ "input": 3, "output": 4 }],
            }]);
        }
    };
    vec![
        edited(
            "an-animation",
            Some("animations are ignored"),
            animation(json!({ "node": 1, "path": "translation" })),
        ),
        edited(
            "an-animation-of-no-node",
            Some("animations are ignored"),
            animation(json!({ "path": "translation" })),
        ),
        edited("a-shape-to-morph-to", Some("morph targets are ignored"), |json| {
            json["meshes"][0]["primitives"][0]["targets"] = json!([{ "POSITION": 0, "TEXCOORD_0": 2 }]);
            json["meshes"][0]["weights"] = json!([0.5]);
        }),
        edited("attributes-of-an-application", None, |json| {
            json["meshes"][0]["primitives"][0]["attributes"]["_HEAT"] = json!(2);
        }),
        edited("copies-in-one-place", None, |json| {
            json["extensionsUsed"] = json!(["KHR_lights_punctual", "EXT_mesh_gpu_instancing"]);
            let extension = json!({ "EXT_mesh_gpu_instancing": { "attributes": { "_ID": 1 } } });
            json["nodes"][0]["extensions"] = extension;
        }),
        edited("a-light-of-no-node", None, |json| {
            push(json, "/extensions/KHR_lights_punctual/lights", json!({ "type": "point" }));
        }),
        edited("a-range", Some("its range is ignored"), |json| {
            json["extensions"]["KHR_lights_punctual"]["lights"][0]["range"] = json!(3);
        }),
        edited("a-flat-camera", Some("camera plan: orthographic"), |json| {
            add_camera(
                json,
                json!(
                    { "type": "orthographic", "orthographic": { "xmag": 1, "ymag": 1, "zfar": 9, "znear": 0 } }
                ),
            )
        }),
    ]
}

fn add_camera(json: &mut Value, camera: Value) {
    push(json, "/cameras", camera);
    push(json, "/nodes", json!({ "name": "plan", "camera": 1 }));
    push(json, "/scenes/0/nodes", json!(3));
}

/// Values that a later version may add.
fn unknown() -> Vec<Form> {
    vec![
        edited("an-unknown-camera", Some("camera plan: orthographic or of an unknown kind"), |json| {
            add_camera(json, json!({ "type": "fisheye" }));
        }),
        edited("a-camera-that-sees-too-wide", Some("camera plan: its yfov is π or more"), |json| {
            add_camera(json, json!({ "type": "perspective", "perspective": { "yfov": 3.2, "znear": 1 } }));
        }),
        edited("an-unknown-alpha-mode", Some("its alphaMode \"DITHER\" is unknown"), |json| {
            json["materials"][0]["alphaMode"] = json!("DITHER");
        }),
        edited("unknown-filters", None, |json| {
            json["samplers"] = json!([{ "magFilter": 1, "minFilter": 2 }]);
            json["textures"][0]["sampler"] = json!(0);
        }),
        edited("an-unknown-way-to-wrap", Some("its wrapS 1 is unknown"), |json| {
            (json["samplers"], json["textures"][0]["sampler"]) = (json!([{ "wrapS": 1 }]), json!(0));
        }),
        edited("an-unknown-target-of-a-view", None, |json| json["bufferViews"][3]["target"] = json!(1)),
        edited("unknown-types-of-unused-accessors", None, |json| {
            for accessor in [
                json!({ "componentType": 5130, "count": 1, "type": "SCALAR" }),
                json!({ "componentType": 5126, "count": 1, "type": "VEC9" }),
            ] {
                push(json, "/accessors", accessor);
            }
        }),
        edited("an-unknown-interpolation", Some("animations are ignored"), |json| {
            json["animations"] = json!([{
                "channels": [{ "sampler": 0, "target": { "path": "pointer" } }],
                "samplers": [{ "input": 3, "output": 4, "interpolation": "BEZIER" }],
            }]);
            for accessor in [
                json!({ "componentType": 5126, "count": 1, "type": "SCALAR", "min": [0], "max": [0] }),
                json!({ "componentType": 5126, "count": 1, "type": "VEC3" }),
            ] {
                push(json, "/accessors", accessor);
            }
        }),
    ]
}
