//! JSON with one wrong value: the importer reads the file or refuses it with an error that names it.

use super::forms::{Plain, plain};
use equilux_bake::gltf_import::import_scene;
use equilux_tests::workshop::Workshop;
use serde_json::{Value, json};

/// The pointers to all members and items below `value`.
fn pointers(value: &Value, at: &str, found: &mut Vec<String>) {
    let below: Vec<(String, &Value)> = match value {
        Value::Object(members) => members.iter().map(|(key, value)| (key.clone(), value)).collect(),
        Value::Array(items) => items.iter().enumerate().map(|(i, value)| (i.to_string(), value)).collect(),
        _ => Vec::new(),
    };
    for (key, value) in below {
        let pointer = format!("{at}/{key}");
        pointers(value, &pointer, found);
        found.push(pointer);
    }
}

fn remove(json: &mut Value, pointer: &str) {
    let (parent, key) = pointer.rsplit_once('/').expect("a pointer");
    match json.pointer_mut(parent).expect("the parent") {
        Value::Object(members) => drop(members.remove(key)),
        Value::Array(items) => drop(items.remove(key.parse().expect("an index"))),
        _ => unreachable!("only objects and lists have members"),
    }
}

#[test]
fn no_wrong_value_in_any_place_makes_the_importer_panic() {
    let workshop = Workshop::new();
    let file = workshop.path("scene.gltf");
    let whole = plain().edited(|json| {
        json["samplers"] = json!([{ "wrapS": 33071, "minFilter": 9728 }]);
        json["textures"][0]["sampler"] = json!(0);
        json["materials"][0]["alphaMode"] = json!("MASK");
        json["accessors"][2]["sparse"] = json!({
            "count": 1, "indices": { "bufferView": 1, "componentType": 5123 }, "values": { "bufferView": 2 },
        });
        let attributes = json!({ "TRANSLATION": 0, "SCALE": 0 });
        json["nodes"][0]["extensions"] = json!({ "EXT_mesh_gpu_instancing": { "attributes": attributes } });
        json["nodes"][0]["extras"] =
            json!({ "element_size": 1, "materials": { "paper": { "emissiveStrength": 2 } } });
    });
    let mut places = Vec::new();
    pointers(&whole.json, "", &mut places);
    assert!(places.len() > 120, "only {} places", places.len());
    let wrong = [
        json!(null),
        json!(-1),
        json!(0.5),
        json!(7),
        json!(u32::MAX),
        json!(u64::MAX),
        json!(1e39),
        json!("?"),
        json!([]),
        json!([0]),
        json!({}),
    ];
    for place in &places {
        for value in wrong.iter().map(Some).chain([None]) {
            let Plain { mut json, binary } = plain().edited(|json| *json = whole.json.clone());
            match value {
                Some(value) => *json.pointer_mut(place).expect("the place") = value.clone(),
                None => remove(&mut json, place),
            }
            let damaged = Plain { json, binary };
            std::fs::write(&file, damaged.text(&damaged.base64())).expect("a written file");
            if let Err(error) = import_scene(&file) {
                let message = error.to_string();
                assert!(message.starts_with(&*file.to_string_lossy()), "{place} = {value:?}: {message}");
                assert!(message.len() < 500, "{place} = {value:?}: {message}");
            }
        }
    }
}
