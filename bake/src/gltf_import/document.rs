//! One glTF file as parsed and validated JSON with all its buffers in memory. In goes a `.gltf` or `.glb` file, out
//! comes a [`Document`] in which every index between JSON objects is valid; nothing is known yet about the bytes.

use super::buffers::read_buffers;
use super::files::Files;
use super::images::read_images;
use super::instancing::INSTANCING;
use super::notes::Notes;
use equilux_formats::{Error, Result};
use gltf::json;
use image::RgbaImage;
use serde::Deserialize;
use std::collections::HashMap;
use std::path::{Path, PathBuf};

/// Extensions a file may require.
const SUPPORTED: [&str; 6] = [
    INSTANCING,
    "KHR_lights_punctual",
    "KHR_materials_emissive_strength",
    "KHR_materials_unlit",
    "KHR_mesh_quantization",
    "KHR_texture_transform",
];

/// A file that was read.
pub(super) struct Document {
    /// Where it lies.
    pub(super) path: PathBuf,
    /// Its JSON.
    pub(super) gltf: gltf::Document,
    /// The bytes of its buffers, each as long as the JSON says.
    pub(super) buffers: Vec<Vec<u8>>,
    /// Those of its images that colour what is baked.
    pub(super) images: HashMap<usize, RgbaImage>,
}

impl Document {
    /// Reads `path`, its buffers and its images. What the file holds but nobody here uses is noted.
    pub(super) fn read(files: &mut Files, path: &Path, notes: &mut Notes) -> Result<Self> {
        let bytes = files.read(path)?;
        let (json, binary) = split(path, &bytes)?;
        check_preamble(path, &json, notes)?;
        let gltf = parse(path, &json)?;
        note_unused(path, &gltf, notes);
        let buffers = read_buffers(files, path, &gltf, binary.as_deref())?;
        let images = read_images(files, path, &gltf, &buffers)?;
        Ok(Self { path: path.to_path_buf(), gltf, buffers, images })
    }

    /// An error about this file.
    pub(super) fn error(
        &self,
        found: impl Into<String>,
        expected: impl Into<String>,
        remedy: impl Into<String>,
    ) -> Error {
        Error::new(&self.path, found, expected, remedy)
    }

    /// The file's name without folder and extension.
    pub(super) fn stem(&self) -> String {
        self.path.file_stem().unwrap_or_default().to_string_lossy().into_owned()
    }
}

fn not_gltf(path: &Path, why: impl std::fmt::Display) -> Error {
    Error::new(
        path,
        format!("not glTF ({why})"),
        "a .gltf or .glb file of version 2",
        "export the file again",
    )
}

type Chunks<'a> = (std::borrow::Cow<'a, [u8]>, Option<std::borrow::Cow<'a, [u8]>>);

/// The JSON and, in a `.glb`, the binary chunk.
fn split<'a>(path: &Path, bytes: &'a [u8]) -> Result<Chunks<'a>> {
    if !bytes.starts_with(b"glTF") {
        return Ok((bytes.into(), None));
    }
    // The crate subtracts the header from the stated length unchecked.
    let stated = bytes.get(8..12).map(|length| u32::from_le_bytes(length.try_into().expect("4 bytes")));
    match stated {
        Some(length) if length >= 12 && length as usize <= bytes.len() => {}
        _ => {
            let stated = stated.map_or("at least 12".to_owned(), |length| length.to_string());
            return Err(not_gltf(
                path,
                format!("truncated: {} bytes, its header says {stated}", bytes.len()),
            ));
        }
    }
    let container = gltf::Glb::from_slice(bytes).map_err(|error| not_gltf(path, error))?;
    Ok((container.json, container.bin))
}

/// What must be known before the JSON is read at large, as a newer version or a required extension may change the rest.
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
struct Asset {
    version: String,
}

fn check_preamble(path: &Path, json: &[u8], notes: &mut Notes) -> Result<()> {
    let preamble: Preamble = serde_json::from_slice(json).map_err(|error| not_gltf(path, error))?;
    if !preamble.asset.version.starts_with("2.") {
        return Err(not_gltf(path, format!("asset.version is '{}'", preamble.asset.version)));
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

fn parse(path: &Path, json: &[u8]) -> Result<gltf::Document> {
    let mut root: json::Root = json::deserialize::from_slice(json).map_err(|error| not_gltf(path, error))?;
    // Checked above; the crate's own list lacks extensions that need no code of its.
    root.extensions_required.clear();
    settle_bounds(path, &mut root)?;
    gltf::Document::from_json(root).map_err(|error| match error {
        gltf::Error::Validation(problems) => not_gltf(path, first_of(&problems)),
        other => not_gltf(path, other),
    })
}

/// Gives every POSITION accessor bounds: they are not used here, but the crate refuses files without them. It also
/// indexes these accessors before it validates the index.
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

fn first_of(problems: &[(json::Path, json::validation::Error)]) -> String {
    match problems {
        [(place, problem)] => format!("{place}: {problem}"),
        [(place, problem), rest @ ..] => format!("{place}: {problem}, and {} more faults", rest.len()),
        [] => "invalid".to_owned(),
    }
}

fn note_unused(path: &Path, gltf: &gltf::Document, notes: &mut Notes) {
    if gltf.animations().len() > 0 {
        notes.add(file_name(path), "animations are ignored");
    }
    if gltf.skins().len() > 0 {
        notes.add(file_name(path), "skins are ignored, meshes stand as modelled");
    }
    if gltf.scenes().len() > 1 {
        notes.add(file_name(path), "of its several scenes only the default one (else the first) is read");
    }
}

/// The name of the file at `path`, to speak of it in notes.
pub(super) fn file_name(path: &Path) -> String {
    path.file_name().unwrap_or_default().to_string_lossy().into_owned()
}
