//! glTF → elements → exact form factors and visibility → local equilibrium → cache.
//!
//! Each glTF file becomes [`equilux_formats::Part`]s, and each part a [`equilux_formats::BakedPart`], in this order:
//!
//! 1. [`gltf_import`] reads a file into parts, instances and lamps; `tidy` removes surfaces that no light can reach.
//! 2. [`elements`] cuts surfaces into elements, faces that block light, and a hierarchy of clusters; [`textures`] gives
//!    elements their mean colours.
//! 3. [`world`] places geometry and knows what blocks light in it; [`meshes`] finds what curved meshes hide.
//! 4. [`treecode`] computes rows of exact form factors ([`form_factor`]); [`rays`] finds first hits of rays.
//! 5. [`equilibrium`] solves a part's own light.
//! 6. [`oven`] runs all this for a part or for many files, and keeps what it makes in a cache.
//!
//! [`geometry`] lies below all of them. `assemble` couples parts with the same form-factor code.

#[cfg(feature = "cli")]
pub mod cli;
pub mod elements;
pub mod equilibrium;
pub mod form_factor;
pub mod geometry;
pub mod gltf_import;
pub mod meshes;
pub mod monitor;
pub mod oven;
pub mod rays;
pub mod textures;
pub mod tidy;
pub mod treecode;
pub mod world;
