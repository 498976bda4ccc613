//! Assembles scenes from baked parts: placed parts → coupling blocks → exchange of light until equilibrium →
//! lightmaps, pictures and a report.
//!
//! [`solve`] lights a scene in memory; [`run`] also writes outputs and a report; [`plan`] is a dry run. The modules,
//! from the lowest layer to the highest:
//!
//! 1. `exchange` solves the radiosity equation of coupled parts: blocks and optics in, radiosity out.
//! 2. `gather` evaluates light at any point, including that of lamps, suns and the sky.
//! 3. `equation` builds the equation of a scene: baked and placed parts, coupling blocks, light from outside.
//! 4. `proof` bounds the error; `verify` and `statistics` compare with the classic matrix.
//! 5. `solve` combines these for a scene.
//! 6. `picture`, `lightmap` and `outputs` write the light; `report` describes the run.
//! 7. `run` executes a job; `cli` and `live` are its front ends; `classic` and `sweep` measure and compare.
//!
//! The modules are public for the tests of the workspace, but hidden; the names below are the library's interface.

#[cfg(feature = "cli")]
#[doc(hidden)]
pub mod classic;
#[cfg(feature = "cli")]
#[doc(hidden)]
pub mod cli;
#[doc(hidden)]
pub mod equation;
#[doc(hidden)]
pub mod exchange;
#[doc(hidden)]
pub mod gather;
#[doc(hidden)]
pub mod lightmap;
#[cfg(feature = "cli")]
#[doc(hidden)]
pub mod live;
mod origin_node;
mod output_file;
#[doc(hidden)]
pub mod outputs;
#[doc(hidden)]
pub mod picture;
#[doc(hidden)]
pub mod placed_parts;
#[doc(hidden)]
pub mod proof;
#[doc(hidden)]
pub mod receivers;
#[doc(hidden)]
pub mod report;
#[doc(hidden)]
pub mod run;
#[doc(hidden)]
pub mod solve;
#[doc(hidden)]
pub mod statistics;
#[cfg(feature = "cli")]
#[doc(hidden)]
pub mod sweep;
mod table;
#[doc(hidden)]
pub mod verify;

pub use equation::observer::Observer;
pub use exchange::listener::{FinishedRound, Listener, Unobserved};
pub use exchange::outcome::{Convergence, Outcome};
pub use exchange::settings::{Goal, Method};
pub use gather::Gather;
pub use gather::points::{Place, PointLight, light as light_at};
pub use gather::sky::Sky;
pub use lightmap::{LightmapOptions, Units};
pub use outputs::requests::{OutputRequests, Pictures};
pub use picture::shot::{Eye, Shading, Shot};
pub use proof::sample::ExactRows;
pub use report::Report;
pub use run::job::Job;
pub use run::plan::{Plan, plan};
pub use run::{run, run_observed};
pub use solve::settings::SolveSettings;
pub use solve::{Solved, solve};
