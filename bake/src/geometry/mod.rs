//! Geometry without light: polygons and clipping, planes, outlines, shells, boxes and hierarchies of boxes.

pub mod aabb;
pub mod box_tree;
mod crossings;
pub mod disjoint_sets;
pub mod outline;
pub mod planes;
pub(crate) mod point_key;
pub mod polygon;
pub mod rounded_placement;
pub mod shaft;
pub mod shells;
pub mod solid_angle;
pub mod solids;
pub mod tolerance;
