//! All tests in one binary: physics first, then contracts.

mod physics;
mod truth;
