//! Scenes as people leave them: faces on faces, walls inside out, far from the origin. The light is right, or a note says
//! what is wrong.

mod far;
mod notes;
mod overlaps;
