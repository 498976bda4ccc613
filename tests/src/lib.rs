//! What the tests and benchmarks share: shapes and scenes made by hand.

pub mod levels;
pub mod shapes;
