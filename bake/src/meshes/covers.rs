//! A line of sight that never hits an edge: it is displaced infinitesimally to one side (symbolic perturbation).

use crate::geometry::tolerance::IN_PLANE;
use glam::DVec3;

/// A direction with symbolic perturbations.
#[derive(Debug, Clone, Copy)]
pub struct Sight {
    /// Unit vector from the receiver's point.
    pub along: DVec3,
    /// The perturbations, at right angles to it; the second counts where the first does not decide.
    leans: [DVec3; 2],
}

impl Sight {
    /// Perturbed towards the unit vector `aside`, which is at a right angle to `along`.
    pub fn beside(along: DVec3, aside: DVec3) -> Self {
        Self { along, leans: [aside, along.cross(aside)] }
    }

    /// Perturbed in an arbitrary direction.
    pub fn along(direction: DVec3) -> Self {
        Self::beside(direction, direction.any_orthonormal_vector())
    }

    /// Whether it passes on the left of the edge a → b (unit vectors), seen from the receiver's point.
    ///
    /// Within [`IN_PLANE`] of an edge the perturbation decides, so that exactly one of two faces that share an edge is
    /// hit, and of two coincident edges neither hides what is beside both.
    pub fn passes_left(&self, a: DVec3, b: DVec3) -> bool {
        let inwards = -a.cross(b - a);
        let height = inwards.dot(self.along);
        if height.abs() > IN_PLANE { height > 0.0 } else { self.passes_left_near(inwards) }
    }

    #[cold]
    fn passes_left_near(&self, inwards: DVec3) -> bool {
        let slack = IN_PLANE * inwards.length();
        let heights = [self.along, self.leans[0], self.leans[1]].map(|d| inwards.dot(d));
        heights.into_iter().find(|height| height.abs() > slack).is_some_and(|height| height > 0.0)
    }

    /// Whether, next to a common point of a face and a sender's plane (unit normals) on the line of sight, the face
    /// lies in front of the plane on the perturbed side.
    ///
    /// A point at distance t in direction d on a plane n·y = n·y₀ moves by t (l − d (n·l)/(n·d)) as d leans towards l.
    pub fn rises(&self, face: DVec3, plane: DVec3) -> bool {
        let slope = face.dot(self.along).recip() * plane.dot(self.along);
        let rise = |lean: DVec3| plane.dot(lean) - slope * face.dot(lean);
        self.leans.into_iter().map(rise).find(|rise| rise.abs() > IN_PLANE).is_some_and(|rise| rise > 0.0)
    }
}
