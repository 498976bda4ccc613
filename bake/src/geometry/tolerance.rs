//! Tolerances of geometry: how far apart two things may be and still count as touching, coplanar or equal.
//!
//! Without units, relative to the length that each names.

/// How close to a plane, relative to the distance, a point counts as lying in it. A point in a sender's plane sees
/// nothing of it and an occluder seen edge-on hides nothing; without this, rounding would make either of them a
/// sliver. A few thousand times the rounding of f64, a millionth of that of f32.
pub const IN_PLANE: f64 = 1e-12;

/// How far, relative to the largest coordinate of the faces concerned, a corner may lie off its plane: two units in the last
/// place of the f32 numbers that glTF stores.
pub const FLATNESS: f64 = 2.0 * f32::EPSILON as f64;
