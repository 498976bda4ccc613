//! Every legal form is read, and the Khronos validator agrees that it is legal.

use super::forms::{Form, forms};
use equilux_bake::gltf_import::import_scene;
use equilux_formats::Scene;
use equilux_tests::script::script;
use equilux_tests::workshop::Workshop;
use serde_json::{Value, json};

/// The scene in the file, without properties that differ between files.
fn imported(workshop: &Workshop, form: &Form) -> Scene {
    let path = workshop.path(&form.name);
    std::fs::write(&path, &form.bytes).expect("a written file");
    let scene = import_scene(&path).unwrap_or_else(|error| panic!("{error}"));
    let noted = |note: &str| scene.notes.iter().any(|found| found.contains(note));
    match form.note {
        Some(note) => assert!(noted(note), "{}: no note '{note}' in {:?}", form.name, scene.notes),
        None => assert_eq!(scene.notes, Vec::<String>::new(), "{}", form.name),
    }
    Scene { name: String::new(), file: "".into(), sources: Vec::new(), notes: Vec::new(), ..scene }
}

#[test]
fn a_scene_in_any_legal_form_is_the_same_scene() {
    let workshop = Workshop::new();
    let forms = forms();
    let plain = imported(&workshop, &forms[0]);
    assert_eq!(
        (plain.parts[0].surfaces.len(), plain.lights.len(), plain.cameras.len()),
        (1, 1, 1),
        "{plain:?}"
    );
    assert!(plain.parts[0].materials[0].textures.reflectance.is_some(), "{plain:?}");
    for form in &forms[1..] {
        assert_eq!(imported(&workshop, form), plain, "{}", form.name);
    }
}

/// Warnings are allowed: what is unknown today may be known tomorrow.
#[test]
fn the_khronos_validator_finds_no_error_in_the_legal_forms() {
    let workshop = Workshop::new();
    let forms = forms();
    for form in &forms {
        std::fs::write(workshop.path(&form.name), &form.bytes).expect("a written file");
    }
    let files: Vec<_> = forms.iter().map(|form| workshop.path(&form.name)).collect();
    let Some(found) = script("validate.js", &json!({ "files": files, "warnings": false })) else { return };
    assert_eq!(found["messages"], json!([]));
    assert_eq!(found["files"], Value::from(forms.len()), "files that were looked at");
}
