//! glTF → elements → exact form factors and visibility → local equilibrium → cache.
//!
//! Each glTF file becomes [`equilux_formats::Part`]s, and each part a [`equilux_formats::BakedPart`], in this order:
//!
//! 1. `gltf_import` reads a file into parts, instances and lamps; `tidy` removes surfaces that no light can reach.
//! 2. `elements` cuts surfaces into elements, faces that block light, and a hierarchy of clusters; `textures` gives
//!    elements their mean colours.
//! 3. `world` holds placed geometry and its occluders; `meshes` computes what curved meshes hide.
//! 4. `treecode` computes rows of exact form factors (`form_factor`); `rays` finds first hits of rays.
//! 5. `equilibrium` solves a part's local equilibrium.
//! 6. `oven` runs these steps for one part or many files and caches the results.
//!
//! `geometry` lies below all of them. `assemble` couples parts with the same form-factor code; for that the modules are
//! public but hidden, and only the names below are the library's face.
//!
//! ```
//! # let folder = tempfile::tempdir()?;
//! use equilux_bake::{EXACT, ElementSize, Monitor, Oven, Preparation, import_scene, prepare};
//! use equilux_formats::Store;
//!
//! let scene = import_scene("../scenes/shadow/shadow.glb".as_ref())?;
//! let element_size = Some(ElementSize::Metres(1.0));
//! let prepared = prepare(&scene, &Preparation { element_size, resolution: EXACT, ..Preparation::default() })?;
//! let (store, monitor) = (Store::open(folder.path())?, Monitor::default());
//! let oven = Oven { store: &store, file: &scene.file, resolution: prepared.resolution, monitor: &monitor };
//! for part in &prepared.parts {
//!     let baked = oven.bake(part)?.part;
//!     println!("{}: {} form factors", baked.name, baked.self_block.stored());
//! }
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

#[cfg(feature = "cli")]
#[doc(hidden)]
pub mod cli;
#[doc(hidden)]
pub mod elements;
#[doc(hidden)]
pub mod equilibrium;
#[doc(hidden)]
pub mod form_factor;
#[doc(hidden)]
pub mod geometry;
#[doc(hidden)]
pub mod gltf_import;
#[doc(hidden)]
pub mod meshes;
#[doc(hidden)]
pub mod monitor;
#[doc(hidden)]
pub mod oven;
#[doc(hidden)]
pub mod rays;
#[doc(hidden)]
pub mod textures;
#[doc(hidden)]
pub mod tidy;
#[doc(hidden)]
pub mod treecode;
#[doc(hidden)]
pub mod world;

pub use elements::ElementSize;
pub use elements::bisect::Cut;
pub use equilibrium::LocalSystem;
pub use geometry::aabb::Aabb;
pub use gltf_import::{import_scene, scenes_in};
pub use monitor::{Monitor, Progress, Step};
pub use oven::batch::{Batch, FileOutcome, PartOutcome, bake_files, find_scenes};
pub use oven::cached::Origin;
pub use oven::prepare::{Division, Preparation, Prepared, PreparedPart, RowMethod, prepare};
pub use oven::{Baked, Oven};
pub use treecode::{Audience, EXACT, Request, Resolution, Timed, block};
pub use world::World;
