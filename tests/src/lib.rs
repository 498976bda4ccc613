//! What the tests and benchmarks share: shapes, rooms and glTF files made by hand, and our programs.

pub mod curved;
pub mod levels;
pub mod measure;
pub mod model;
pub mod program;
pub mod rooms;
pub mod shapes;
