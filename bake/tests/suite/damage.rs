//! Damaged, truncated and misplaced files are refused with an error that names them.

use crate::gltf::{Folder, Gltf, container};
use crate::refusals::refused;
use serde_json::{Value, json};

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
