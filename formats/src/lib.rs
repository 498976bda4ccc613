//! What Equilux stores and passes on, without any physics.
//!
//! Data flows glTF → [`Part`] → [`BakedPart`] → [`Scene`] → blocks of [`Rows`] → [`Solution`]. `bake` and `assemble`
//! compute on these types; this crate only says what they are and how they lie on disk.

mod baked;
mod error;
mod geometry;
mod ids;
mod part;
mod rows;
mod scene;
mod solution;

pub use baked::{BakedGeometry, BakedLight, BakedPart, Factors, LocalEquilibrium, Lu};
pub use error::{Error, Result};
pub use geometry::{Corners, Element, Face, Geometry, Optics};
pub use ids::{ElementId, FaceId, InstanceId, MaterialId, PartId};
pub use part::{LocalSolver, Material, Part, Surface};
pub use rows::{Rgb, Rows};
pub use scene::{Camera, Instance, LightKind, PunctualLight, Scene};
pub use solution::Solution;
