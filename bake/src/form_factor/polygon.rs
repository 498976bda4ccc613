//! Convex polygons and the two cuts they suffer: by a plane, and by the pyramid that an occluder hides.
//!
//! All points are relative to the receiver's collocation point, so every plane of a pyramid passes through the
//! origin and is given by its normal alone.

use glam::DVec3;
use smallvec::SmallVec;

/// A planar convex polygon, corners in order. Ten corners lie in place; more spill to the heap, none are dropped.
pub type Polygon = SmallVec<[DVec3; 10]>;

/// What lies on one side of a plane.
#[derive(Debug)]
pub enum Side {
    /// The whole polygon.
    All,
    /// Nothing, or no more than an edge.
    None,
    /// This piece of it.
    Piece(Polygon),
}

/// The part of `polygon` where `distance` (an affine function of the point) is positive. Corners on the plane belong
/// to both sides, and a polygon that only touches the plane is not cut. No epsilon: signs decide, and the cut point
/// lies between the corners it came from.
pub fn clip(polygon: &[DVec3], distance: impl Fn(DVec3) -> f64) -> Side {
    let distances: SmallVec<[f64; 12]> = polygon.iter().map(|&p| distance(p)).collect();
    if distances.iter().all(|&d| d >= 0.0) {
        return if distances.iter().any(|&d| d > 0.0) { Side::All } else { Side::None };
    }
    if distances.iter().all(|&d| d <= 0.0) {
        return Side::None;
    }
    let mut piece = Polygon::new();
    for (i, (&p, &dp)) in polygon.iter().zip(&distances).enumerate() {
        let next = if i + 1 == polygon.len() { 0 } else { i + 1 };
        let (q, dq) = (polygon[next], distances[next]);
        if dp >= 0.0 {
            piece.push(p);
        }
        if (dp > 0.0 && dq < 0.0) || (dp < 0.0 && dq > 0.0) {
            piece.push(p + (q - p) * (dp / (dp - dq)));
        }
    }
    Side::Piece(piece)
}

/// The pyramid of directions that a convex occluder hides from the origin.
#[derive(Debug, Clone)]
pub struct Pyramid {
    /// Normals of the planes through the origin and one edge each, pointing inwards.
    planes: Polygon,
}

impl Pyramid {
    /// The pyramid over `occluder`, which must lie wholly in the open half space before the sender's plane and whose
    /// own plane must not contain the origin.
    pub fn over(occluder: &[DVec3], normal: DVec3) -> Self {
        // Seen from the origin the corners run counter-clockwise around the inside if the normal points away from it.
        let facing = if normal.dot(occluder[0]) > 0.0 { 1.0 } else { -1.0 };
        let planes = (0..occluder.len())
            .map(|i| {
                let (a, b) = (occluder[i], occluder[(i + 1) % occluder.len()]);
                a.cross(b - a) * facing
            })
            .collect();
        Self { planes }
    }

    /// Whether `polygon` surely has nothing inside: it lies wholly behind one of the planes.
    pub fn misses(&self, polygon: &[DVec3]) -> bool {
        self.planes.iter().any(|plane| polygon.iter().all(|p| plane.dot(*p) <= 0.0))
    }

    /// Append to `outside` the convex pieces of `polygon` that the pyramid does not hide.
    ///
    /// One plane after the other cuts off what lies behind it; what is left in the end is hidden.
    pub fn subtract_from(&self, polygon: Polygon, outside: &mut Vec<Polygon>) {
        if self.misses(&polygon) {
            outside.push(polygon);
            return;
        }
        let mut inside = polygon;
        for plane in &self.planes {
            match clip(&inside, |p| -plane.dot(p)) {
                Side::None => {}
                Side::All => {
                    outside.push(inside);
                    return;
                }
                Side::Piece(piece) => {
                    outside.push(piece);
                    match clip(&inside, |p| plane.dot(p)) {
                        Side::Piece(rest) => inside = rest,
                        Side::All => {}
                        Side::None => return,
                    }
                }
            }
        }
    }
}
