//! Parts in their places → who interacts → coupling blocks → exchange until equilibrium → pictures and a report.
//!
//! What comes in is a scene's file and a cache of baked parts; what goes out is a [`report::Report`] and the files it
//! names.

mod account;
pub mod advice;
#[cfg(feature = "cli")]
pub mod baseline;
pub mod camera;
pub mod canvas;
pub mod classic;
#[cfg(feature = "cli")]
pub mod cli;
pub mod coupling;
pub mod direct;
pub mod elements_csv;
pub mod equation;
pub mod exchange;
mod explain;
pub mod exposure;
pub mod gather;
pub mod gltf_export;
pub mod hull;
mod light_notes;
pub mod lightmap;
#[cfg(feature = "cli")]
pub mod live;
pub mod observer;
mod older;
pub mod output_file;
mod outputs;
pub mod picture;
pub mod placed;
pub mod plan;
pub mod points;
pub mod proof;
pub mod render;
pub mod report;
pub mod run;
pub mod scene_light;
mod steps;
#[cfg(feature = "cli")]
pub mod sweep;
pub mod table;
mod unlit;
mod warm;
#[cfg(feature = "cli")]
pub mod watch;
