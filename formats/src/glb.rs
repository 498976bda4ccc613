//! The binary container of glTF, `.glb`: a JSON chunk and a binary chunk. glTF 2.0 specification, §4.4.
//!
//! Reading skips chunks of other types and bytes after the stated length, as the specification requires. The `gltf`
//! crate is not used because it refuses such files.

use std::io::{self, Write};

/// The JSON of a file and, in a `.glb`, its binary chunk.
#[derive(Debug)]
pub struct Chunks<'a> {
    /// The text of the JSON.
    pub json: &'a [u8],
    /// The binary chunk, if there is one.
    pub binary: Option<&'a [u8]>,
}

/// Bytes before the first chunk: magic, version, length.
const HEADER: usize = 12;

/// Bytes before the contents of a chunk: length, type.
const CHUNK_HEADER: usize = 8;

/// Writes a container of two chunks to `out`, each padded to a multiple of four bytes: the JSON with spaces, the binary
/// chunk with zeros. Fails if `out` fails, or if the file would have 4 GiB or more.
pub fn write(out: &mut (impl Write + ?Sized), json: &[u8], binary: &[u8]) -> io::Result<()> {
    let length = HEADER
        + [json, binary].map(|chunk| CHUNK_HEADER + chunk.len().next_multiple_of(4)).iter().sum::<usize>();
    let length = u32::try_from(length).map_err(|_| io::Error::other("a .glb file of 4 GiB or more"))?;
    out.write_all(b"glTF")?;
    out.write_all(&2_u32.to_le_bytes())?;
    out.write_all(&length.to_le_bytes())?;
    for (kind, chunk, fill) in [(b"JSON", json, b' '), (b"BIN\0", binary, 0)] {
        let padded = chunk.len().next_multiple_of(4);
        out.write_all(&(padded as u32).to_le_bytes())?;
        out.write_all(kind)?;
        out.write_all(chunk)?;
        out.write_all(&[fill; 4][..padded - chunk.len()])?;
    }
    Ok(())
}

/// The bytes of a container of two chunks, as [`write()`] writes it.
pub fn file(json: &[u8], binary: &[u8]) -> io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    write(&mut bytes, json, binary)?;
    Ok(bytes)
}

/// Splits `bytes` into chunks; bytes that do not start with a container's magic are JSON. Fails with a description of
/// what is wrong with the container.
pub fn split(bytes: &[u8]) -> Result<Chunks<'_>, String> {
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_container_is_laid_out_as_the_specification_draws_it() {
        let bytes = file(b"{\"a\":1}", b"xyzuv").unwrap();
        let header = b"glTF\x02\0\0\0\x2c\0\0\0";
        let json = b"\x08\0\0\0JSON{\"a\":1} ";
        let binary = b"\x08\0\0\0BIN\0xyzuv\0\0\0";
        assert_eq!(bytes, [&header[..], json, binary].concat());
        let chunks = split(&bytes).unwrap();
        assert_eq!((chunks.json, chunks.binary), (&b"{\"a\":1} "[..], Some(&b"xyzuv\0\0\0"[..])));
    }
}
