//! The bytes behind a glTF file: its binary chunk, `data:` URIs, and files beside it.

use super::files::Files;
use base64::Engine as _;
use base64::prelude::BASE64_STANDARD;
use equilux_formats::{Error, Result};
use gltf::buffer::Source;
use percent_encoding::percent_decode_str;
use std::path::Path;

/// The bytes of every buffer of `gltf`, each as long as its `byteLength` says.
pub(super) fn read_buffers(
    files: &mut Files,
    path: &Path,
    gltf: &gltf::Document,
    binary: Option<&[u8]>,
) -> Result<Vec<Vec<u8>>> {
    gltf.buffers().map(|buffer| read_buffer(files, path, &buffer, binary)).collect()
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

/// What `uri` in the file at `path` means: data, or another file. `what` says in errors what for.
pub(super) fn uri_bytes(files: &mut Files, path: &Path, uri: &str, what: &str) -> Result<Vec<u8>> {
    if let Some(data) = uri.strip_prefix("data:") {
        return decode(path, what, data);
    }
    let uri = percent_decode_str(uri).decode_utf8_lossy();
    let file = files.resolve(path, &uri)?;
    files.read(&file)
}

fn decode(path: &Path, what: &str, data: &str) -> Result<Vec<u8>> {
    let broken = |why: String| {
        Error::new(
            path,
            format!("{what} with a data URI that {why}"),
            "data:…;base64,…",
            "export the file again",
        )
    };
    let (_, encoded) = data.split_once(";base64,").ok_or_else(|| broken("is not base64".to_owned()))?;
    BASE64_STANDARD.decode(encoded).map_err(|error| broken(format!("cannot be decoded as base64 ({error})")))
}
