//! Exact form factors from a point to a polygon behind any number of occluders.
//!
//! [`plain`] reads like the equation and is the oracle; [`row`] computes whole rows and shares what can be shared.

pub mod block;
pub mod contour;
pub mod plain;
pub mod polygon;
pub mod row;
