//! Truths of light that every way of computing must keep.

mod closed;
mod curved;
mod shells;
mod touching;
