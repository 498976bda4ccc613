//! Meshes as occluders: what of a sender polygon a mesh of thousands of faces hides from a point.
//!
//! Seen from a point, what a mesh hides is bounded by its silhouette: the edges on whose two sides not as much is
//! hidden, which of a closed mesh are those between faces that look at the point and faces that do not. Visibility on a
//! sender changes nowhere else, except where the mesh goes through the sender itself. So a sender is cut along the few
//! silhouette edges that are seen before it, instead of along every edge of every face, and stays exact. Compare Appel
//! 1967, who counts what hides along such edges; here a face is asked where it matters.
//!
//! [`Mesh`] is made once, [`SeenMesh`] once a receiver, [`SeenPolygon`] once a receiver and sender; an [`Obstruction`]
//! is one of each, and cuts.

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
