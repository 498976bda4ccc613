//! What files and the cache promise.

mod container;
mod keeping;
mod manifest;
mod samples;
mod store;
