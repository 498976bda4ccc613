//! Untidy scenes: overlapping faces, walls inside out, coordinates far from the origin. The light is right, or a note
//! names the problem.

mod far;
mod notes;
mod overlaps;
