//! Tests of files and the cache.

mod container;
mod keeping;
mod manifest;
mod samples;
mod store;
