//! glTF → elements → exact form factors and visibility → local equilibrium → cache.
//!
//! What comes in is a file; what goes out is a [`equilux_formats::BakedPart`] for each part in it. The form-factor code
//! lives here because `assemble` couples parts with the same.

pub mod batch;
pub mod bisect;
pub mod cached;
#[cfg(feature = "cli")]
pub mod cli;
pub mod clusters;
pub mod cuts;
pub mod depfile;
mod disjoint_sets;
pub mod elements;
pub mod enclosed_lamps;
pub mod equilibrium;
pub mod form_factor;
pub mod gltf_import;
pub mod keys;
pub mod merge;
pub mod meshes;
pub mod monitor;
pub mod occluders;
pub mod outline;
pub mod oven;
pub mod planes;
pub mod prepare;
pub mod shaft;
pub mod shells;
pub mod solids;
pub mod stamp;
pub mod textures;
mod tidy;
pub mod treecode;
pub mod visibility;
pub mod world;
