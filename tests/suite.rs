//! All tests in one binary: physics first, then contracts.

mod bad_input;
mod cache;
mod cli;
mod crash;
mod gltf;
mod lightmaps;
mod lights;
mod live;
mod parts;
mod physics;
mod rays;
mod stiff;
mod sweep;
mod textures;
mod truth;
mod untidy;
