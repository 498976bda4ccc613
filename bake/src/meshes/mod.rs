//! Closed meshes as occluders: what of a sender polygon a mesh of thousands of faces hides from a point.
//!
//! Seen from a point, what a closed mesh hides is bounded by its silhouette: the edges between faces that look at the
//! point and faces that do not. Visibility on a sender changes nowhere else, except where the mesh goes through the
//! sender's own plane. So a sender is cut along the few silhouette edges that are seen before it, instead of along
//! every edge of every face, and stays exact. Appel 1967 for the counting, here replaced by asking which face is in
//! the way where it matters.
//!
//! [`Mesh`] is made once, [`SeenMesh`] once a receiver, [`SeenPolygon`] once a receiver and sender.

mod arc;
mod covers;
mod crossings;
mod directions;
mod mesh;
mod obstruction;
mod pieces;
mod seen;
mod sender;
mod touching_itself;

pub use directions::{Span, Spans};
pub use mesh::Mesh;
pub use obstruction::Obstruction;
pub use pieces::Splitter;
pub use seen::SeenMesh;
pub use sender::SeenPolygon;
