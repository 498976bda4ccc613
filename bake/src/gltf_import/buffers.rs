//! Reads the buffers of a glTF file: its binary chunk, `data:` URIs, and files beside it.

use super::files::Files;
use data_url::DataUrl;
use equilux_formats::{Error, Result};
use gltf::buffer::{Source, View};
use percent_encoding::percent_decode_str;
use std::path::{Path, PathBuf};

/// The buffers of a file. An unreadable buffer is an error only where it is used: extensions may have buffers that the
/// importer ignores.
pub(super) struct Buffers {
    path: PathBuf,
    buffers: Vec<Result<Vec<u8>>>,
}

impl Buffers {
    /// The buffers of `gltf`, the file at `path`, each of its `byteLength`.
    pub(super) fn read(files: &mut Files, path: &Path, gltf: &gltf::Document, binary: Option<&[u8]>) -> Self {
        let buffers = gltf.buffers().map(|buffer| read_buffer(files, path, &buffer, binary));
        Self { path: path.to_path_buf(), buffers: buffers.collect() }
    }

    /// The bytes of `view`. Errors call them `what`.
    pub(super) fn view(&self, view: &View, what: &str) -> Result<&[u8]> {
        let buffer = self.buffers[view.buffer().index()].as_ref().map_err(Error::clone)?;
        let end = view.offset().checked_add(view.length());
        end.and_then(|end| buffer.get(view.offset()..end)).ok_or_else(|| {
            Error::new(
                &self.path,
                format!("{what}: buffer view {} reaches past its buffer", view.index()),
                format!("a view within the buffer's {} bytes", buffer.len()),
                "export the file again, it contradicts itself or is truncated",
            )
        })
    }
}

fn read_buffer(
    files: &mut Files,
    path: &Path,
    buffer: &gltf::Buffer,
    binary: Option<&[u8]>,
) -> Result<Vec<u8>> {
    let mut bytes = match buffer.source() {
        Source::Bin => binary.filter(|_| buffer.index() == 0).map(<[u8]>::to_vec).ok_or_else(|| {
            Error::new(
                path,
                format!("buffer {} without uri or binary chunk", buffer.index()),
                "bytes for every buffer",
                "export the file again, as .glb or with its .bin",
            )
        })?,
        Source::Uri(uri) => uri_bytes(files, path, uri, &format!("buffer {}", buffer.index()))?,
    };
    if bytes.len() < buffer.length() {
        return Err(Error::new(
            path,
            format!("buffer {} of {} bytes", buffer.index(), bytes.len()),
            format!("its byteLength, {} bytes", buffer.length()),
            "export the file again, it is truncated or its parts do not belong together",
        ));
    }
    bytes.truncate(buffer.length());
    Ok(bytes)
}

/// The bytes that `uri` in the file at `path` refers to: data, or another file. Errors call them `what`.
pub(super) fn uri_bytes(files: &mut Files, path: &Path, uri: &str, what: &str) -> Result<Vec<u8>> {
    if uri.get(..5).is_some_and(|scheme| scheme.eq_ignore_ascii_case("data:")) {
        return decode(uri).map_err(|why| {
            Error::new(
                path,
                format!("{what} with a data URI that {why}"),
                "data:…;base64,… or percent-encoded bytes",
                "export the file again",
            )
        });
    }
    let uri = percent_decode_str(uri).decode_utf8_lossy();
    let file = files.resolve(path, &uri, what)?;
    files.read_referenced(path, &file, what)
}

/// The bytes of a `data:` URI, base64 or percent-encoded (RFC 2397).
fn decode(uri: &str) -> std::result::Result<Vec<u8>, String> {
    let url = DataUrl::process(uri).map_err(|error| format!("is malformed ({error})"))?;
    let (bytes, _) = url.decode_to_vec().map_err(|error| format!("cannot be decoded as base64 ({error})"))?;
    Ok(bytes)
}
