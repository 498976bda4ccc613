//! Meshes as occluders: the part of a sender polygon that a mesh of thousands of faces hides from a point.
//!
//! Seen from a point, the hidden region is bounded by the mesh's silhouette: the edges whose two sides differ in what
//! is hidden. In a closed mesh these are the edges between faces that face the point and faces that do not. Visibility
//! on a sender changes nowhere else, except where the mesh intersects the sender itself. A sender is therefore cut
//! along the few silhouette edges in front of it, instead of along every edge of every face, and the result stays
//! exact. Compare Appel 1967, who counts hiding surfaces along such edges; here faces are tested where it matters.
//!
//! A [`Mesh`] is computed once, a [`SeenMesh`] once a receiver, a [`SeenPolygon`] once a receiver and sender. An
//! [`Obstruction`] combines a `SeenMesh` and a `SeenPolygon`, and cuts the sender.

mod arc;
mod covers;
mod crossings;
mod directions;
mod from_faces;
mod mesh;
mod obstruction;
mod pieces;
mod seen;
mod sender;
mod touching_itself;

pub use directions::{Span, Spans};
pub use mesh::Mesh;
pub use obstruction::Obstruction;
pub use seen::SeenMesh;
pub use sender::SeenPolygon;
