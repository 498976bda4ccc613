//! Data types of Equilux and their storage, without physics.
//!
//! Data flows glTF → [`Part`] → [`BakedPart`] → [`Scene`] → blocks of [`Rows`] → [`Solution`]. `bake` and `assemble`
//! compute on these types; this crate defines the types and their file formats. A value is stored under the key of a
//! manifest, which lists what the value was made from:
//!
//! ```
//! # let folder = tempfile::tempdir()?;
//! use equilux_formats::fingerprint::Manifest;
//! use equilux_formats::store::Lookup;
//! use equilux_formats::{Solution, Store};
//!
//! let store = Store::open(folder.path())?;
//! let manifest = Manifest::new().setting("scene", "hall.glb").setting("element size", "0.25 m");
//! store.save(&manifest, &Solution { instances: vec![], radiosity: vec![] })?;
//! assert!(matches!(store.load::<Solution>(&manifest.key()), Lookup::Found(_)));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

pub mod baked;
mod clusters;
pub mod container;
mod error;
pub mod fingerprint;
mod geometry;
pub mod glb;
mod ids;
mod part;
mod rgb;
pub mod rows;
mod scene;
pub mod solution;
mod source_rows;
pub mod store;
pub mod stored;
pub mod texture;
pub mod whole_file;

pub use baked::BakedPart;
pub use clusters::ClusterTree;
pub use error::{Error, Problem, Result, unless_stopped};
pub use geometry::{Corners, Element, Face, Geometry, Optics, Patches, Tints};
pub use ids::{FaceId, MaterialId, PartId};
pub use part::{LocalSolver, Material, Part, Surface, TexelChoice};
pub use rgb::Rgb;
pub use rows::Rows;
pub use scene::{Camera, Instance, LightKind, LightUnits, PunctualLight, Repainted, Scene};
pub use solution::Solution;
pub use source_rows::SourceRows;
pub use store::Store;
