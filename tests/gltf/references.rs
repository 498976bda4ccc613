//! References to other files: errors name the glTF file, the referring object, and the reference.

use super::forms::plain;
use equilux_bake::gltf_import::import_scene;
use equilux_tests::workshop::Workshop;
use serde_json::json;

#[test]
fn a_reference_that_leads_nowhere_is_named_with_its_file() {
    let workshop = Workshop::new();
    std::fs::create_dir(workshop.path("folder")).expect("a folder");
    let file = workshop.path("scene.gltf");
    for (reference, words) in [
        ("", "which is empty"),
        (".", "which is a folder"),
        ("folder", "which is a folder"),
        ("./folder/..", "which is a folder"),
        ("%2E", "which is a folder"),
        ("missing.bin", "missing.bin cannot be read"),
        ("folder/missing.bin", "missing.bin cannot be read"),
        ("..", "which leaves the scene's folder"),
        ("/etc/passwd", "which is an absolute path"),
        ("file:///etc/passwd", "which is a URL or an absolute path"),
    ] {
        let image = plain().edited(|json| json["images"][0] = json!({ "name": "bark", "uri": reference }));
        let part = plain().edited(|json| json["nodes"][0]["extras"] = json!({ "part": reference }));
        for (what, bytes) in [
            ("buffer 0", plain().text(reference)),
            ("image bark", image.text(&image.base64())),
            ("node hall", part.text(&part.base64())),
        ] {
            // Extras are no URIs; an empty path is refused as a value.
            if what == "node hall" && ["", "%2E"].contains(&reference) {
                continue;
            }
            std::fs::write(&file, bytes).expect("a written file");
            let error = import_scene(&file).expect_err("a reference that leads nowhere").to_string();
            let named = format!("{}: {what} with the reference '", file.display());
            assert!(error.starts_with(&named) && error.contains(words), "'{reference}' of {what}: {error}");
        }
    }
}
