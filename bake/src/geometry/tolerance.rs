//! Tolerances of geometry: how far apart two things may be and still count as touching, coplanar or equal. All are
//! relative: each names the length, area or angle that it is a share of.
//!
//! Coordinates come as f32 and are computed with in f64, so there are three scales. What arithmetic adds is some 1e-15
//! and is covered by 1e-12 or less. What f32 leaves of a plane or a length is some 1e-7 and is covered by [`FLATNESS`] up
//! to 1e-6. In between, 1e-9 lies a factor of a hundred and more from either: it separates what is equal but for
//! arithmetic from what differs in the file.

// Arithmetic: f64.

/// How close to a plane, relative to the distance, a point counts as lying in it. A point in a sender's plane sees
/// nothing of it and an occluder seen edge-on hides nothing; without this, rounding would make either of them a
/// sliver. A few thousand times the rounding of f64, a millionth of that of f32.
pub const IN_PLANE: f64 = 1e-12;

/// The error of a corner that was cut, relative to its distance from the origin: the roundings of a few sums and products.
pub(crate) const CUT_ROUNDING: f64 = 4.0 * f64::EPSILON;

/// The relative error of about ten operations.
pub(crate) const TEN_OPERATIONS: f64 = 16.0 * f64::EPSILON;

/// The error of a triple product, relative to the lengths of its vectors: about eight roundings.
pub(crate) const TRIPLE_PRODUCT: f64 = 1e-15;

// Equal but for arithmetic: 1e-9.

/// Corners with a smaller sine of their angle lie on the line between their neighbours.
pub(crate) const STRAIGHT: f64 = 1e-9;

/// How far the area of the hull may exceed that of what it is the hull of, relative, to be the same polygon.
pub(crate) const SAME_AREA: f64 = 1e-9;

/// An edge must be longer than another by more than this, relative, to be the longer one.
pub(crate) const LONGER: f64 = 1e-9;

/// How far from the edges of a face, relative to the mesh, its inside begins: faces that share a corner touch there.
pub(crate) const INSIDE_A_FACE: f64 = 1e-9;

/// A smaller volume, relative to the area to the power of 3/2, counts as zero, as that of a two-sided sheet.
pub(crate) const NO_VOLUME: f64 = 1e-9;

/// How far from the plane that cuts a geometry, relative to its extent, a corner still counts as on it: no slivers are
/// made where a plane follows an edge.
pub(crate) const ON_CUT: f64 = 1e-9;

/// Hits of a ray within this distance of each other, relative to their distance, are one hit. Hits within this share of
/// a segment's length from its ends do not count.
pub(crate) const SAME_HIT: f64 = 1e-9;

// What files store: f32, or what an exporter leaves of it.

/// How far, relative to the largest coordinate of the faces concerned, a corner may lie off its plane: two units in the last
/// place of the f32 numbers that glTF stores.
pub const FLATNESS: f64 = 2.0 * f32::EPSILON as f64;

/// Points nearer to a face than this, relative to its extent or distance, may be part of it: f32 corners of its own
/// elements are as far off its plane.
pub(crate) const ON_FACE: f64 = 4.0 * FLATNESS;

/// A shorter arc, in radians, does not determine on its own which of its sides is hidden; a face does. About the f32
/// rounding of a direction.
pub(crate) const SHORTEST_ARC: f64 = 1e-7;

/// How far boxes of directions, kept in f32, reach beyond what they hold: more than f32 rounds.
pub(crate) const DIRECTION_MARGIN: f32 = 1e-6;

/// A mesh counts as wholly before a plane, or apart from a sender, only if it is this far from it, relative to its
/// size; if not, each of its faces is tested.
pub(crate) const APART: f64 = 1e-6;

/// How far the sum of a closed shell's areas, as vectors, may be from zero, relative to their sum as numbers: corners that
/// several faces share are equal to the bit, but for those that lie on another's edge.
pub(crate) const CLOSED: f64 = 1e-6;

/// Smaller distances between positions, relative to the extent, are rounding and no grid line.
pub(crate) const SAME_LINE: f64 = 1e-6;

/// Lengths that differ by less than this, relative, are equal: the same shape in other units is cut in the same way.
pub(crate) const SAME_LENGTH: f64 = 1e-6;

/// How far a transform may be from a similarity, relative: what f32 leaves of a rotation.
pub(crate) const SIMILARITY: f64 = 1e-6;

/// How far elements that were cut out of joined surfaces may lie off these, relative to the largest coordinate.
pub(crate) const JOINED: f64 = 1e-6;

/// How far in front of an emitting surface its light is taken to start, in diagonals of its part or shell: a panel that
/// lies in a room's ceiling emits into the room. Larger than the f32 rounding of a plane.
pub(crate) const IN_FRONT: f64 = 1e-5;

// Inaccuracy of modelling tools and authors.

/// How far, in steps of f32, the fourth corner of a quad may be off: each of the four corners was rounded.
pub(crate) const ROUNDED_CORNERS: f64 = 4.0;

/// How far, in diagonals, the fourth corner of a quad may be off its plane: beyond that a quad would be visibly bent,
/// however coarse its steps are.
pub(crate) const BENT_QUAD: f64 = 1e-4;

/// How far a quad made of two triangles may lie off one of them, in its longest edges: the importer's flatness for each.
pub(crate) const BENT: f64 = 2.0 * BENT_QUAD;

/// How far from 1 the winding number of a point inside may be; on a face it is ½.
pub(crate) const WOUND: f64 = 1e-3;
