//! Parts in their places → who interacts → coupling blocks → exchange until equilibrium → pictures and a report.
//!
//! What comes in is a scene's file and a cache of baked parts; what goes out is a [`report::Report`] and the files it
//! names.

#[cfg(feature = "cli")]
pub mod classic;
#[cfg(feature = "cli")]
pub mod cli;
pub mod equation;
pub mod exchange;
pub mod gather;
pub mod lightmap;
#[cfg(feature = "cli")]
pub mod live;
pub mod output_file;
pub mod outputs;
pub mod picture;
pub mod placed;
pub mod proof;
pub mod report;
pub mod run;
pub mod solve;
pub mod statistics;
#[cfg(feature = "cli")]
pub mod sweep;
pub mod table;
pub mod verify;

pub use solve::settings::SolveSettings;
pub use solve::{Solved, solve};
