//! The edges of a convex occluder. Its silhouette consists of those between a side that faces the viewer and one that
//! does not. A face has two sides back to back; a convex solid has as many as faces.

use glam::DVec3;

/// A convex occluder by its edges.
#[derive(Debug, Clone, Default)]
pub struct Outline {
    /// Its sides.
    pub sides: Vec<Plane>,
    /// Its edges.
    pub edges: Vec<Edge>,
    /// An upper bound of its largest extent.
    pub size: f64,
    /// Whether it is a face, which hides nothing from a point in its plane.
    pub thin: bool,
}

/// A plane through `point`; it faces the half-space that `normal` points into.
#[derive(Debug, Clone, Copy)]
pub struct Plane {
    /// Unit normal, outwards.
    pub normal: DVec3,
    /// A point of it.
    pub point: DVec3,
}

/// An edge, counter-clockwise around the side on its left seen from outside.
#[derive(Debug, Clone, Copy)]
pub struct Edge {
    /// Where it begins and ends.
    pub ends: [DVec3; 2],
    /// The side on its left.
    pub left: u32,
    /// The side on its right; [`NO_SIDE`] where a cut took it away.
    pub right: u32,
}

/// A side that faces no viewer.
pub const NO_SIDE: u32 = u32::MAX;

impl Outline {
    /// The outline of a planar convex polygon, corners counter-clockwise around `normal`.
    pub fn of_face(corners: &[DVec3], normal: DVec3) -> Self {
        let edge = |(i, &a): (usize, &DVec3)| {
            let b = corners[if i + 1 == corners.len() { 0 } else { i + 1 }];
            Edge { ends: [a, b], left: 0, right: 1 }
        };
        let point = corners[0];
        Self {
            sides: vec![Plane { normal, point }, Plane { normal: -normal, point }],
            edges: corners.iter().enumerate().map(edge).collect(),
            size: 2.0 * corners.iter().map(|&p| (p - point).length()).fold(0.0, f64::max),
            thin: true,
        }
    }

    /// The outline of the piece of a solid where `height` (affine) is above zero. `faces` are the corners of its sides.
    /// The receiver must be above as well, so that the cut does not face it.
    pub fn above<'a>(&self, faces: impl Iterator<Item = &'a [DVec3]>, height: impl Fn(DVec3) -> f64) -> Self {
        let reaches_up = |edge: &&Edge| edge.ends.iter().any(|&p| height(p) > 0.0);
        let mut edges: Vec<Edge> = self.edges.iter().filter(reaches_up).copied().collect();
        for (side, corners) in faces.enumerate() {
            if let Some(ends) = cut_edge(corners, &height) {
                edges.push(Edge { ends, left: side as u32, right: NO_SIDE });
            }
        }
        Self { sides: self.sides.clone(), edges, size: self.size, thin: false }
    }
}

/// The edge that closes the piece of a convex polygon above a plane, in the order of the piece's corners.
fn cut_edge(corners: &[DVec3], height: impl Fn(DVec3) -> f64) -> Option<[DVec3; 2]> {
    let (mut exit, mut entry) = (None, None);
    for (i, &a) in corners.iter().enumerate() {
        let b = corners[(i + 1) % corners.len()];
        let (ha, hb) = (height(a), height(b));
        if (ha > 0.0) != (hb > 0.0) {
            let cut = a + (b - a) * (ha / (ha - hb));
            if ha > 0.0 { exit = Some(cut) } else { entry = Some(cut) }
        }
    }
    exit.zip(entry).map(|(exit, entry)| [exit, entry])
}
