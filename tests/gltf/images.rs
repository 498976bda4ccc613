//! The image of a texture, and empty images.

use super::forms::{Plain, picture, plain, push};
use equilux_bake::gltf_import::import_scene;
use equilux_formats::{Result, Scene};
use equilux_tests::workshop::Workshop;
use image::ImageFormat;
use serde_json::{Value, json};

fn import(plain: &Plain) -> Result<Scene> {
    let workshop = Workshop::new();
    std::fs::write(workshop.path("scene.gltf"), plain.text(&plain.base64())).expect("a written file");
    import_scene(&workshop.path("scene.gltf"))
}

/// The plain scene with a second image.
fn with_image(bytes: Vec<u8>, edit: impl FnOnce(&mut Value)) -> Plain {
    let mut plain = plain();
    let offset = plain.binary.len();
    let view = json!({ "buffer": 0, "byteOffset": offset, "byteLength": bytes.len() });
    push(&mut plain.json, "/bufferViews", view);
    push(&mut plain.json, "/images", json!({ "name": "modern", "bufferView": 4, "mimeType": "image/webp" }));
    plain.json["extensionsUsed"] = json!(["KHR_lights_punctual", "EXT_texture_webp"]);
    plain.binary.extend(bytes);
    plain.edited(edit)
}

#[test]
fn a_webp_image_comes_before_the_fallback() {
    let webp = json!({ "EXT_texture_webp": { "source": 1 } });
    for (case, texture, required, expected) in [
        ("with a fallback", json!({ "source": 0, "extensions": webp }), false, [10, 200, 30]),
        ("alone", json!({ "extensions": webp }), true, [10, 200, 30]),
        ("as a plain source", json!({ "source": 1 }), false, [10, 200, 30]),
        ("only elsewhere", json!({ "source": 0 }), true, [255, 128, 64]),
    ] {
        let scene = import(&with_image(picture(ImageFormat::WebP, [10, 200, 30]), |json| {
            json["textures"] = json!([texture]);
            if required {
                json["extensionsRequired"] = json!(["EXT_texture_webp"]);
            }
        }));
        let scene = scene.unwrap_or_else(|error| panic!("{case}: {error}"));
        let texture = scene.parts[0].materials[0].textures.reflectance.as_ref().expect("a texture");
        assert_eq!((texture.size, &texture.texels[0][..3]), ([2, 2], &expected[..]), "{case}");
        assert_eq!(scene.notes, Vec::<String>::new(), "{case}");
    }
}

/// An image matters where a material's colour needs it, and only there.
#[test]
fn images_that_cannot_be_read_are_named_where_they_are_needed() {
    for (case, image, words) in [
        ("no data", json!({ "name": "bark" }), "image bark with neither uri nor bufferView"),
        ("no data, no name", json!({ "mimeType": "image/png" }), "image 1 with neither uri nor bufferView"),
        ("not an image", json!({ "name": "bark", "bufferView": 0 }), "image bark cannot be decoded"),
        (
            "past the end",
            json!({ "name": "bark", "bufferView": 4 }),
            "image bark: buffer view 4 reaches past",
        ),
        ("no buffer", json!({ "name": "bark", "bufferView": 5 }), "buffer 1 without uri"),
        ("no file", json!({ "uri": "bark.png" }), "image bark.png with the reference 'bark.png'"),
        (
            "broken data",
            json!({ "name": "bark", "uri": "data:image/png;base64,A" }),
            "image bark with a data URI",
        ),
    ] {
        for needed in [true, false] {
            let found = import(&plain().edited(|json| {
                push(json, "/images", image.clone());
                push(json, "/bufferViews", json!({ "buffer": 0, "byteLength": 9999 }));
                push(json, "/bufferViews", json!({ "buffer": 1, "byteLength": 4 }));
                json["buffers"] = json!([{ "byteLength": 4 }]);
                json["textures"][0]["source"] = json!(u8::from(needed));
            }));
            match found {
                Err(error) => {
                    let message = error.to_string();
                    assert!(needed, "{case}: not needed, yet refused: {message}");
                    assert!(message.contains("scene.gltf: ") && message.contains(words), "{case}: {message}");
                }
                Ok(scene) => {
                    assert!(!needed, "{case}: accepted, with the notes {:?}", scene.notes);
                    let noted = scene.notes.iter().any(|note| note.contains("neither uri nor bufferView"));
                    assert_eq!(noted, case.starts_with("no data"), "{case}: {:?}", scene.notes);
                }
            }
        }
    }
}
