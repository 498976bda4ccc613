//! Extent of a group of receivers, and their orientation if they all lie on one side of one face.

use crate::geometry::aabb::Aabb;
use crate::geometry::polygon::{Polygon, convex_hull};
use crate::geometry::tolerance::IN_PLANE;
use crate::world::{Sender, World};
use equilux_formats::{Element, FaceId};
use glam::DVec3;

/// The convex hull of a group of receivers.
#[derive(Debug)]
pub struct Viewers {
    /// Box around their points.
    pub bounds: Aabb,
    /// Largest extent.
    pub diameter: f64,
    /// Corners of the convex hull of their points, or of the box.
    pub hull: Polygon,
    /// The side of the face they lie on, if it is the same for all.
    pub flat: Option<Flat>,
}

/// The face that viewers lie in.
#[derive(Debug)]
pub struct Flat {
    /// Unit normal of their side.
    pub normal: DVec3,
    /// The face.
    pub face: FaceId,
    /// The occluder they lie on.
    pub occluder: u32,
}

impl Viewers {
    /// The viewers at the centroids of these elements, at least one.
    pub fn new(world: &World, elements: &[Element]) -> Self {
        let first = &elements[0];
        let points = || elements.iter().map(|e| e.centroid);
        let bounds = Aabb::around(points());
        let same_side = |e: &Element| e.face == first.face && e.normal.dot(first.normal) > 0.0;
        let flat = elements.iter().all(same_side).then(|| Flat {
            normal: first.normal,
            face: first.face,
            occluder: world.occluders().of_face[first.face.index()],
        });
        let hull = match flat {
            Some(_) if elements.len() > 4 => convex_hull(points(), first.normal),
            _ if elements.len() <= 4 => points().collect(),
            _ => bounds.corners(),
        };
        Self { bounds, diameter: bounds.diagonal(), hull, flat }
    }

    /// Distance from the box around the viewers to the box around a sender.
    pub fn distance_to(&self, sender: &Sender) -> f64 {
        let (own, other) = (&self.bounds, &sender.bounds);
        (other.low - own.high).max(own.low - other.high).max(DVec3::ZERO).length()
    }

    /// Whether a sender lies wholly below the horizon, in the viewers' plane, or faces away from all of them.
    pub fn cannot_see(&self, sender: &Sender, world: &World) -> bool {
        let origin = self.hull[0];
        let (centre, half) = (sender.bounds.centre(), sender.bounds.size() * 0.5);
        let reach = (centre - origin).length() + half.length();
        if let Some(Flat { normal, face, .. }) = self.flat {
            if normal.dot(centre - origin) + normal.abs().dot(half) <= IN_PLANE * reach {
                return true;
            }
            if sender.side.is_some_and(|side| world.coplanar(side.face, face)) {
                return true;
            }
        }
        let Some(side) = sender.side else { return false };
        let corner = world.faces[side.face.index()].corners[0];
        self.hull.iter().all(|&p| side.normal.dot(p - corner) <= IN_PLANE * reach)
    }
}
