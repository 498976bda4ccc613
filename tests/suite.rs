//! All tests in one binary: physics first, then contracts.

mod bad_input;
mod cli;
mod parts;
mod physics;
mod stiff;
mod truth;
