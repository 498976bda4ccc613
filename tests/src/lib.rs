//! Shared code of tests and benchmarks: shapes, rooms, glTF files, the two programs, and cases with known solutions.

pub mod assembled;
pub mod averages;
pub mod cases;
pub mod corridors;
pub mod curved;
pub mod edited;
pub mod levels;
pub mod lit;
pub mod measure;
pub mod model;
pub mod modular;
pub mod program;
pub mod rooms;
pub mod script;
pub mod shapes;
pub mod smooth;
pub mod table;
pub mod truth;
pub mod workshop;
