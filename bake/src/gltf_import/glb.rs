//! The binary container of glTF: `.glb` bytes → JSON and binary chunk. glTF 2.0 specification, §4.4.
//!
//! Chunks of other types and bytes after the stated length are skipped, as the specification asks. Own code, as the
//! `gltf` crate refuses such files.

/// The JSON of a file and, in a `.glb`, its binary chunk.
pub(super) struct Chunks<'a> {
    pub(super) json: &'a [u8],
    pub(super) binary: Option<&'a [u8]>,
}

/// Bytes before the first chunk: magic, version, length.
const HEADER: usize = 12;

/// Bytes before the contents of a chunk: length, type.
const CHUNK_HEADER: usize = 8;

/// Splits `bytes`, which are JSON unless they start as a container does. Fails with what is wrong with the container.
pub(super) fn split(bytes: &[u8]) -> Result<Chunks<'_>, String> {
    if !bytes.starts_with(b"glTF") {
        // The specification allows readers to ignore a byte order mark.
        let json = bytes.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(bytes);
        return Ok(Chunks { json, binary: None });
    }
    let stated = number(bytes, 8).filter(|&length| (HEADER..=bytes.len()).contains(&length));
    let Some(length) = stated else {
        let stated = number(bytes, 8).map_or("at least 12".to_owned(), |length| length.to_string());
        return Err(format!("truncated: {} bytes, its header says {stated}", bytes.len()));
    };
    match number(bytes, 4) {
        Some(2) => {}
        version => return Err(format!("a container of version {}", version.unwrap_or_default())),
    }
    let chunks = chunks(&bytes[HEADER..length])?;
    let [(b"JSON", json), rest @ ..] = &chunks[..] else {
        return Err("its first chunk is not JSON".to_owned());
    };
    let binary = rest.iter().find(|(kind, _)| *kind == b"BIN\0").map(|&(_, bytes)| bytes);
    Ok(Chunks { json, binary })
}

/// Type and contents.
type Chunk<'a> = (&'a [u8], &'a [u8]);

fn chunks(mut rest: &[u8]) -> Result<Vec<Chunk<'_>>, String> {
    let mut chunks = Vec::new();
    while rest.len() >= CHUNK_HEADER {
        let whole =
            number(rest, 0).and_then(|length| rest.split_at_checked(length.checked_add(CHUNK_HEADER)?));
        let Some((chunk, after)) = whole else {
            return Err(format!("truncated: chunk {} reaches past the end", chunks.len()));
        };
        chunks.push((&chunk[4..8], &chunk[CHUNK_HEADER..]));
        rest = after;
    }
    Ok(chunks)
}

/// The number at `offset`, if the bytes reach that far.
fn number(bytes: &[u8], offset: usize) -> Option<usize> {
    let bytes = bytes.get(offset..)?.first_chunk()?;
    Some(u32::from_le_bytes(*bytes) as usize)
}
