//! Opens a `.gltf` or `.glb` file as a [`Document`], with buffers and images, and refuses files that are not valid glTF 2.0.

use super::buffers::Buffers;
use super::document::Document;
use super::files::{Files, file_name};
use super::images::read_images;
use super::instancing::INSTANCING;
use super::normal_form::{SPECULAR_GLOSSINESS, WEBP, normalise};
use super::notes::Notes;
use equilux_formats::glb::{Chunks, split};
use equilux_formats::{Error, Result};
use gltf::json;
use gltf::json::validation::{Error as Fault, Validate};
use serde::Deserialize;
use serde_json::Value;
use std::path::Path;

/// Extensions a file may require.
const SUPPORTED: [&str; 8] = [
    INSTANCING,
    WEBP,
    "KHR_lights_punctual",
    "KHR_materials_emissive_strength",
    SPECULAR_GLOSSINESS,
    "KHR_materials_unlit",
    "KHR_mesh_quantization",
    "KHR_texture_transform",
];

/// Reads `path`, its buffers and its images. Notes the contents that the importer does not use.
pub(super) fn read(files: &mut Files, path: &Path, notes: &mut Notes) -> Result<Document> {
    let bytes = files.read(path)?;
    let Chunks { json, binary } = split(&bytes).map_err(|why| not_gltf(path, why))?;
    let mut json: Value = serde_json::from_slice(json).map_err(|error| not_gltf(path, error))?;
    check_preamble(path, &json, notes)?;
    normalise(&mut json, &file_name(path), notes);
    let gltf = parse(path, json)?;
    if gltf.scenes().len() > 1 {
        notes.add(file_name(path), "of its several scenes only the default one (else the first) is read");
    }
    let buffers = Buffers::read(files, path, &gltf, binary);
    let images = read_images(files, path, &gltf, &buffers, notes)?;
    Ok(Document { path: path.to_path_buf(), gltf, buffers, images })
}

fn not_gltf(path: &Path, why: impl std::fmt::Display) -> Error {
    Error::new(
        path,
        format!("not glTF ({why})"),
        "a .gltf or .glb file of version 2",
        "export the file again",
    )
}

/// The properties checked before the rest of the JSON, which a newer version or a required extension may change.
#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
struct Preamble {
    asset: Asset,
    #[serde(default)]
    extensions_required: Vec<String>,
    #[serde(default)]
    extensions_used: Vec<String>,
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
struct Asset {
    version: String,
    min_version: Option<String>,
}

fn check_preamble(path: &Path, json: &Value, notes: &mut Notes) -> Result<()> {
    let preamble = Preamble::deserialize(json).map_err(|error| not_gltf(path, error))?;
    let Asset { version, min_version } = preamble.asset;
    if !version.starts_with("2.") {
        return Err(not_gltf(path, format!("asset.version is '{version}'")));
    }
    if let Some(least) = min_version.filter(|least| least != "2.0") {
        return Err(not_gltf(path, format!("asset.minVersion is '{least}', this build reads 2.0")));
    }
    let unknown = |extension: &&String| !SUPPORTED.contains(&extension.as_str());
    if let Some(extension) = preamble.extensions_required.iter().find(unknown) {
        return Err(Error::new(
            path,
            format!("it requires the extension {extension}"),
            format!("no required extension but {}", SUPPORTED.join(", ")),
            format!("export without {extension}"),
        ));
    }
    for extension in preamble.extensions_used.iter().filter(unknown) {
        notes.add(file_name(path), format!("the extension {extension} is ignored"));
    }
    Ok(())
}

fn parse(path: &Path, json: Value) -> Result<gltf::Document> {
    let mut root: json::Root = serde_json::from_value(json).map_err(|error| not_gltf(path, error))?;
    // Checked above; the crate's own list lacks extensions that it need not implement.
    root.extensions_required.clear();
    settle_bounds(path, &mut root)?;
    let mut faults = Vec::new();
    root.validate(&root, json::Path::new, &mut |place, fault| {
        let place = place();
        if !is_legal(place.as_str(), fault) {
            faults.push((place, fault));
        }
    });
    match first_of(&faults) {
        Some(fault) => Err(not_gltf(path, fault)),
        None => Ok(gltf::Document::from_json_without_validation(root)),
    }
}

/// Adds bounds to every POSITION accessor: they are unused, but the crate refuses files without them. Also checks the
/// indices of these accessors, which the crate uses before it validates them.
fn settle_bounds(path: &Path, root: &mut json::Root) -> Result<()> {
    let positions = json::validation::Checked::Valid(json::mesh::Semantic::Positions);
    for primitive in root.meshes.iter().flat_map(|mesh| &mesh.primitives) {
        let Some(index) = primitive.attributes.get(&positions) else { continue };
        let count = root.accessors.len();
        let accessor = root.accessors.get_mut(index.value()).ok_or_else(|| {
            not_gltf(path, format!("POSITION names accessor {index}, the file has {count} accessors"))
        })?;
        let bound = || Some(serde_json::json!([0.0, 0.0, 0.0]));
        (accessor.min, accessor.max) = (bound(), bound());
    }
    Ok(())
}

/// Whether the crate reports a fault that the specification allows: an accessor without a buffer view holds zeros
/// (§3.6.2.1), and one of an unknown type is a fault only where it is used, which is checked there.
fn is_legal(place: &str, fault: Fault) -> bool {
    let member =
        place.strip_prefix("accessors[").and_then(|place| place.split_once("].")).map(|(_, member)| member);
    matches!(
        (member, fault),
        (Some("bufferView"), Fault::Missing) | (Some("componentType" | "type"), Fault::Invalid)
    )
}

fn first_of(faults: &[(json::Path, Fault)]) -> Option<String> {
    match faults {
        [] => None,
        [(place, fault)] => Some(format!("{place}: {fault}")),
        [(place, fault), rest @ ..] => Some(format!("{place}: {fault}, and {} more faults", rest.len())),
    }
}
