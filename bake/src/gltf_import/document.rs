//! One glTF file as parsed and validated JSON with all its buffers in memory: every index between JSON objects is
//! valid; the bytes are not checked yet.

use super::buffers::Buffers;
use equilux_formats::Error;
use image::RgbaImage;
use std::collections::HashMap;
use std::path::PathBuf;

/// A glTF file in memory.
pub(super) struct Document {
    /// Where it lies.
    pub(super) path: PathBuf,
    /// Its JSON.
    pub(super) gltf: gltf::Document,
    /// The bytes of its buffers.
    pub(super) buffers: Buffers,
    /// The images that colour surfaces.
    pub(super) images: HashMap<usize, RgbaImage>,
}

impl Document {
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

/// The name of a node: its own, its mesh's, or its number.
pub(super) fn label(node: &gltf::Node) -> String {
    let named = node.name().or_else(|| node.mesh().and_then(|mesh| mesh.name()));
    named.filter(|name| !name.is_empty()).map_or_else(|| format!("node {}", node.index()), str::to_owned)
}
