//! Rays: first hits in placed geometry, and whole rows of form factors from one hemisphere of counted rays.
//!
//! A row by rays is F_ij = k_ij / R: of R rays that leave element i, distributed over its area and by the cosine over its
//! hemisphere, k_ij end on element j. Its expectation is the form factor averaged over both areas (Cohen & Wallace 1993,
//! §4.2), whatever stands in between, and its cost depends on R alone.
//!
//! ```text
//! sobol → samples → hemisphere      directions and origins of an element's rays
//! wide_tree, plates → face_tree     the first face that a ray meets in a part, in its coordinates; lanes: eight numbers
//! element_grid → surfaces           the unknown at a place on a face
//! scenery                           the same among placed parts
//! alone → counts → recounts         what the rays of a row end on, in its part, in a scene, after an edit; replicas: how uncertain that is
//! areas                             what the rays of pieces of surface that are no unknowns end on
//! obstacles                         what may stand between two groups of places
//! sources                           form factors to small, bright polygons, by shadow rays
//! ```
//!
//! `index` finds first hits among elements, for pictures, and as the independent check of all of these.

pub mod alone;
pub mod areas;
pub mod counts;
mod element_grid;
mod face_tree;
pub mod hemisphere;
mod index;
mod lanes;
mod obstacles;
mod plates;
pub mod recounts;
pub mod replicas;
pub mod samples;
pub mod scenery;
#[cfg(test)]
pub(crate) mod shapes;
pub mod sobol;
pub mod sources;
pub mod surfaces;
mod tracing;
mod wide_tree;

pub use index::{Hit, RayIndex};
pub use wide_tree::Ray;
