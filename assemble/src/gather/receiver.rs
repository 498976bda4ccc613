//! Points that receive light, as elements without area.

use equilux_formats::{Corners, Element, FaceId, MaterialId};
use glam::DVec3;

/// A receiver at a point, on one side of a face of the world.
pub fn receiver(point: DVec3, normal: DVec3, face: FaceId) -> Element {
    Element {
        corners: Corners::triangle([point; 3]),
        normal,
        centroid: point,
        area: 0.0,
        material: MaterialId(0),
        face,
    }
}
