//! One array as one zstd frame.

use super::Number;
use std::io::{self, Read, Write};

/// 16 MiB, eight times the window of the compression level.
const WINDOW_LOG_MAX: u32 = 24;
/// Size of decoded chunks: memory grows with the actual data, not with the length in the index.
const CHUNK: usize = 1 << 16;

/// The bytes as a frame.
pub(super) fn compress(bytes: &[u8]) -> io::Result<Vec<u8>> {
    let mut encoder = zstd::Encoder::new(vec![], zstd::DEFAULT_COMPRESSION_LEVEL)?;
    encoder.include_checksum(true)?;
    encoder.set_pledged_src_size(Some(bytes.len() as u64))?;
    encoder.write_all(bytes)?;
    encoder.finish()
}

/// `count` numbers from a frame that must hold exactly these.
pub(super) fn decompress<T: Number>(frame: &[u8], count: u64) -> io::Result<Vec<T>> {
    let mut decoder = zstd::Decoder::with_buffer(frame)?;
    decoder.window_log_max(WINDOW_LOG_MAX)?;
    let mut values = vec![];
    while (values.len() as u64) < count {
        let start = values.len();
        let chunk = (count - start as u64).min(CHUNK as u64) as usize;
        values.resize(start + chunk, T::zeroed());
        decoder.read_exact(bytemuck::cast_slice_mut(&mut values[start..]))?;
    }
    match decoder.read(&mut [0])? {
        0 => Ok(values),
        _ => Err(io::Error::other("more numbers than in the index")),
    }
}
