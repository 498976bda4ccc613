//! Physical laws that every method must satisfy.

mod closed;
mod curved;
mod shells;
mod touching;
