//! Exact form factors from a point to a polygon behind any number of occluders.
//!
//! [`plain`] follows the equation and is the reference in tests; [`wide`] and [`edges`] compute the same for many
//! receivers, or many polygons, at once.

pub mod contour;
pub mod edges;
pub mod plain;
pub mod wide;
