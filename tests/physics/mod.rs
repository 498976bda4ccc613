//! Truths of light that every way of computing must keep.

mod closed;
mod curved;
mod from_a_point;
mod touching;
