//! Rewrites the JSON of a glTF file to a form that the `gltf` crate accepts. The crate refuses, or panics on, much that
//! the specification allows: integers written as 1.0, optional lists that are missing, values that a later version may
//! add. Unused properties are removed, so that the crate does not validate them. glTF 2.0 specification, §3 and §5.

use super::notes::Notes;
use serde_json::{Map, Value, json};

/// Alternative images of textures, in WebP.
pub(super) const WEBP: &str = "EXT_texture_webp";

/// The older material model, whose diffuse colour replaces the base colour.
pub(super) const SPECULAR_GLOSSINESS: &str = "KHR_materials_pbrSpecularGlossiness";

/// Rewrites `root`, the JSON of a file that notes call `file`. Removed properties that may matter are noted.
pub(super) fn normalise(root: &mut Value, file: &str, notes: &mut Notes) {
    whole_numbers(root);
    remove_unused(root, file, notes);
    for (_, scene) in items(root, "scenes") {
        scene.entry("nodes").or_insert_with(|| json!([]));
    }
    items(root, "textures").for_each(|(_, texture)| choose_source(texture));
    for (index, material) in items(root, "materials") {
        let subject = label("material", index, material);
        use_diffuse_colour(material, &subject, notes);
        keep_known(material, "alphaMode", &["OPAQUE", "MASK", "BLEND"], &subject, notes);
    }
    for (index, sampler) in items(root, "samplers") {
        let subject = label("sampler", index, sampler);
        ["wrapS", "wrapT"]
            .iter()
            .for_each(|side| keep_known(sampler, side, &[33_071, 33_648, 10_497], &subject, notes));
    }
    for (index, mesh) in items(root, "meshes") {
        keep_primitives(mesh, &label("mesh", index, mesh), notes);
    }
    items(root, "cameras").for_each(|(_, camera)| settle_camera(camera));
    if let Some(lights) = root.pointer_mut("/extensions/KHR_lights_punctual") {
        items(lights, "lights")
            .for_each(|(index, light)| settle_light(light, &label("light", index, light), notes));
    }
}

/// The objects in the list `list` of `of`, with their places in it.
fn items<'a>(of: &'a mut Value, list: &str) -> impl Iterator<Item = (usize, &'a mut Map<String, Value>)> {
    let items = of.get_mut(list).and_then(Value::as_array_mut);
    items.into_iter().flatten().enumerate().filter_map(|(index, item)| Some((index, item.as_object_mut()?)))
}

/// The label of an object in notes: its name, or its number.
fn label(kind: &str, index: usize, object: &Map<String, Value>) -> String {
    let name = object.get("name").and_then(Value::as_str).filter(|name| !name.is_empty());
    name.map_or_else(|| format!("{kind} {index}"), |name| format!("{kind} {name}"))
}

/// Converts numbers without a fraction to integers. JSON has one kind of number, so 1.0 is a valid index.
fn whole_numbers(value: &mut Value) {
    // Above this not every integer is an f64.
    const EXACT: f64 = 9_007_199_254_740_992.0;
    match value {
        Value::Number(number) => {
            let fraction = number.as_f64().filter(|_| number.is_f64());
            // -0.0 keeps its sign.
            let whole = fraction
                .filter(|x| x.fract() == 0.0 && x.abs() < EXACT && (*x != 0.0 || x.is_sign_positive()));
            if let Some(whole) = whole {
                *number = (whole as i64).into();
            }
        }
        Value::Array(items) => items.iter_mut().for_each(whole_numbers),
        Value::Object(members) => members.values_mut().for_each(whole_numbers),
        _ => {}
    }
}

/// Removes what does not affect static, diffuse light.
fn remove_unused(root: &mut Value, file: &str, notes: &mut Notes) {
    let mut take = |list: &str| root.as_object_mut().and_then(|root| root.remove(list)).is_some();
    if take("animations") {
        notes.add(file, "animations are ignored");
    }
    if take("skins") {
        notes.add(file, "skins are ignored, meshes stand as modelled");
    }
    for (list, members) in [
        ("nodes", &["skin", "weights"][..]),
        ("meshes", &["weights"]),
        ("bufferViews", &["target"]),
        ("samplers", &["minFilter", "magFilter"]),
    ] {
        for (_, item) in items(root, list) {
            members.iter().for_each(|member| drop(item.remove(*member)));
        }
    }
}

/// Removes the member `key` if its value is none of `known`, so that its default holds.
fn keep_known<T: Copy + Into<Value>>(
    object: &mut Map<String, Value>,
    key: &str,
    known: &[T],
    subject: &str,
    notes: &mut Notes,
) {
    let is_unknown = |value: &Value| known.iter().all(|&known| *value != known.into());
    if let Some(value) = object.get(key).cloned().filter(is_unknown) {
        object.remove(key);
        notes.add(subject, format!("its {key} {value} is unknown and ignored"));
    }
}

/// Selects the image of a texture's extension over the fallback for readers without the extension.
fn choose_source(texture: &mut Map<String, Value>) {
    let preferred =
        texture.get("extensions").and_then(|extensions| extensions.get(WEBP)?.get("source").cloned());
    if let Some(source) = preferred {
        texture.insert("source".to_owned(), source);
    }
}

/// Larger specular colours are those of metals, whose colour is not diffuse.
const DIELECTRIC: f64 = 0.1;

/// Writes the diffuse colour of the older model as the base colour of a material that is not metallic.
fn use_diffuse_colour(material: &mut Map<String, Value>, subject: &str, notes: &mut Notes) {
    let extensions = material.get_mut("extensions").and_then(Value::as_object_mut);
    let older = extensions.and_then(|extensions| extensions.remove(SPECULAR_GLOSSINESS));
    let Some(Value::Object(mut older)) = older else { return };
    let mut model = json!({ "metallicFactor": 0 });
    for (theirs, ours) in [("diffuseFactor", "baseColorFactor"), ("diffuseTexture", "baseColorTexture")] {
        if let Some(value) = older.remove(theirs) {
            model[ours] = value;
        }
    }
    material.insert("pbrMetallicRoughness".to_owned(), model);
    let specular = older.get("specularFactor").and_then(Value::as_array);
    let is_shiny = |factor: &Value| factor.as_f64().is_none_or(|factor| factor > DIELECTRIC);
    if specular.is_none_or(|factors| factors.iter().any(is_shiny)) {
        notes.add(subject, "its specular reflection is ignored, it reflects its diffuse colour");
    }
}

/// Keeps the primitives with positions and a known mode, and the attributes that are read.
fn keep_primitives(mesh: &mut Map<String, Value>, subject: &str, notes: &mut Notes) {
    let Some(primitives) = mesh.get_mut("primitives").and_then(Value::as_array_mut) else { return };
    primitives.retain_mut(|primitive| {
        let Some(primitive) = primitive.as_object_mut() else { return true };
        if primitive.remove("targets").is_some() {
            notes.add(subject, "morph targets are ignored");
        }
        if let Some(attributes) = primitive.get_mut("attributes").and_then(Value::as_object_mut) {
            attributes.retain(|name, _| is_attribute(name));
        }
        let has_positions =
            primitive.get("attributes").is_none_or(|attributes| attributes.get("POSITION").is_some());
        let mode = primitive.get("mode").and_then(Value::as_u64).unwrap_or(4);
        if !has_positions {
            notes.add(subject, "primitives without POSITION are ignored");
        } else if mode > 6 {
            notes.add(subject, format!("primitives of the unknown mode {mode} are ignored"));
        }
        has_positions && mode <= 6
    });
}

/// Whether this is one of the attributes of a vertex that are read here.
fn is_attribute(name: &str) -> bool {
    let set = |prefix| name.strip_prefix(prefix).is_some_and(|set: &str| set.parse::<u32>().is_ok());
    name == "POSITION" || name == "NORMAL" || set("TEXCOORD_") || set("COLOR_")
}

/// Replaces cameras of unknown kinds by orthographic ones; neither is supported.
fn settle_camera(camera: &mut Map<String, Value>) {
    let kind = camera.get("type").and_then(Value::as_str).unwrap_or_default();
    if !["perspective", "orthographic"].contains(&kind) {
        camera.insert("type".to_owned(), json!("orthographic"));
        camera.insert("orthographic".to_owned(), json!({ "xmag": 1, "ymag": 1, "zfar": 1, "znear": 0 }));
        camera.remove("perspective");
    }
}

/// Adds the default cone to a spot without one, and switches off lights of unknown kinds.
fn settle_light(light: &mut Map<String, Value>, subject: &str, notes: &mut Notes) {
    let kind = light.get("type").and_then(Value::as_str).unwrap_or_default().to_owned();
    if kind == "spot" {
        light.entry("spot").or_insert_with(|| json!({}));
    } else if !["point", "directional"].contains(&&*kind) {
        notes.add(subject, format!("of the unknown type '{kind}', and gives no light"));
        light.insert("type".to_owned(), json!("point"));
        light.insert("intensity".to_owned(), json!(0));
    }
    if light.remove("range").is_some() {
        notes.add(subject, "its range is ignored, its light reaches any distance");
    }
}
