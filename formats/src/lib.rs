//! Data types of Equilux and their storage, without physics.
//!
//! Data flows glTF → [`Part`] → [`BakedPart`] → [`Scene`] → blocks of [`Rows`] → [`Solution`]. `bake` and `assemble`
//! compute on these types; this crate defines the types and their file formats.

mod baked;
mod clusters;
mod container;
mod error;
mod fingerprint;
mod geometry;
pub mod glb;
mod ids;
mod part;
mod rgb;
mod rows;
mod scene;
mod solution;
mod store;
mod stored;
mod texture;
mod whole_file;

pub use baked::{BakedGeometry, BakedLight, BakedPart, BoundaryResponses, Factors, LocalEquilibrium, Lu};
pub use clusters::ClusterTree;
pub use container::{FORMAT_VERSION, Kind, Number, Reader, Writer};
pub use error::{Error, Problem, Result, unless_stopped};
pub use fingerprint::{Content, Digest, Key, Manifest};
pub use geometry::{Corners, Element, Face, Geometry, Optics, Tints};
pub use ids::{ElementId, FaceId, InstanceId, MaterialId, PartId};
pub use part::{LocalSolver, Material, Part, Surface};
pub use rgb::Rgb;
pub use rows::{Precision, RowGroup, RowSumDefect, Rows, SINGLE_ROUNDING};
pub use scene::{Camera, Instance, LightKind, LightUnits, PunctualLight, Repainted, Scene};
pub use solution::{Solution, SolvedInstance};
pub use store::{Evicted, Lookup, Store, Tally, Turn};
pub use stored::Stored;
pub use texture::{Texture, TexturedTriangle, Textures, Wrap};
pub use whole_file::{check_writable_beside, remove_left_over_beside, write_whole};
