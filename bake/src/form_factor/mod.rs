//! Exact form factors from a point to a polygon behind any number of occluders.
//!
//! [`plain`] reads like the equation and is the oracle; [`wide`] and [`edges`] compute the same for many receivers, or
//! many polygons, at once.

pub mod contour;
pub mod edges;
pub mod plain;
pub mod wide;
