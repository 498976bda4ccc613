//! Exact form factors from a point to a polygon behind any number of occluders.
//!
//! [`plain`] reads like the equation and is the oracle; [`wide`] computes the same for many receivers
//! at once.

pub mod contour;
pub mod plain;
pub mod polygon;
pub mod wide;
