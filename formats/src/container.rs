//! The file format: a fixed header, two messages, then arrays, each compressed separately. `FORMAT.md` describes it.
//!
//! Files hold metadata and arrays of numbers. Every byte is covered by a checksum that is verified before the byte is
//! used, so a file that is damaged, foreign or of another version results in an [`Error`](crate::Error).

mod frame;
mod reader;
mod writer;

pub use reader::Reader;
pub use writer::Writer;

use crate::fingerprint::Manifest;
use serde::{Deserialize, Serialize};

#[cfg(not(target_endian = "little"))]
compile_error!("arrays are written as they lie in memory, which must be little-endian");

/// The version this build writes, and the only one it reads.
pub const FORMAT_VERSION: u32 = 5;

const MAGIC: [u8; 8] = *b"EQUILUX\0";
const HEADER_LENGTH: usize = 56;
/// Far above any manifest; limits the memory that a crafted length can allocate.
const MESSAGES_LIMIT: u64 = 1 << 24;

/// The contents of a file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// Geometry and form factors of a part.
    Part,
    /// Optics and local equilibrium of a part.
    Light,
    /// A block of form factors between two instances.
    Coupling,
    /// Form factors from an instance to sources of light.
    Sources,
    /// Only a manifest: the latest inputs of a named result.
    Manifest,
    /// The light of a scene.
    Solution,
    /// Only a manifest and a key: the result of these inputs equals the one under that key.
    Alias,
}

impl Kind {
    /// All kinds.
    pub(crate) const ALL: [Self; 6] =
        [Self::Part, Self::Light, Self::Coupling, Self::Sources, Self::Manifest, Self::Alias];

    /// The four bytes in the header.
    fn code(self) -> [u8; 4] {
        match self {
            Self::Part => *b"PART",
            Self::Light => *b"LGHT",
            Self::Coupling => *b"COUP",
            Self::Sources => *b"SRCS",
            Self::Manifest => *b"MANI",
            Self::Solution => *b"SOLN",
            Self::Alias => *b"ALIA",
        }
    }

    /// The name in file names and messages.
    pub fn noun(self) -> &'static str {
        match self {
            Self::Part => "part",
            Self::Light => "light",
            Self::Coupling => "coupling",
            Self::Sources => "sources",
            Self::Manifest => "manifest",
            Self::Solution => "solution",
            Self::Alias => "alias",
        }
    }
}

/// A type of numbers in arrays.
pub trait Number: bytemuck::Pod {
    /// Its name in the index.
    const NAME: &'static str;
}

macro_rules! number {
    ($($number:ident)*) => {
        $(impl Number for $number {
            const NAME: &'static str = stringify!($number);
        })*
    };
}
number!(u16 u32 u64 f32 f64);

/// The first of the two messages. The second is the metadata, whose type depends on the kind.
#[derive(Debug, Serialize, Deserialize)]
struct Index {
    manifest: Manifest,
    arrays: Vec<ArrayEntry>,
}

#[derive(Debug, Clone, Serialize, Deserialize)]
struct ArrayEntry {
    name: String,
    number: String,
    count: u64,
    /// Bytes of the compressed frame.
    length: u64,
    /// blake3 of the compressed frame.
    checksum: [u8; 32],
}

/// The header up to its checksum.
fn header(kind: [u8; 4], messages_length: u64) -> Vec<u8> {
    [&MAGIC[..], &FORMAT_VERSION.to_le_bytes(), &kind, &messages_length.to_le_bytes()].concat()
}

fn checksum(header: &[u8], messages: &[u8]) -> [u8; 32] {
    *blake3::Hasher::new().update(header).update(messages).finalize().as_bytes()
}
