//! A piece of a silhouette edge as seen from the receiver's point: on one side of it, something is hidden.

use super::directions::Span;
use crate::geometry::tolerance::IN_PLANE;
use glam::DVec3;

/// A segment in front of a sender, with the side on which a face hides what is behind it.
#[derive(Debug, Clone, Copy)]
pub struct Arc {
    /// Unit vectors from the receiver's point to the ends.
    pub ends: [DVec3; 2],
    /// Distances of the ends.
    far: [f64; 2],
    /// Unit normal of the plane through the receiver's point, towards the side that is hidden.
    pub hidden: DVec3,
    /// The face on the hidden side, by its position in the mesh.
    pub face: u32,
}

impl Arc {
    /// The arc from one point to another, relative to the receiver's, with what is hidden on its left; none if it is
    /// seen end-on.
    pub fn new([a, b]: [DVec3; 2], face: u32) -> Option<Self> {
        let far = [a.length(), b.length()];
        let ends = [a / far[0], b / far[1]];
        let normal = -ends[0].cross(ends[1] - ends[0]);
        let sine = normal.length();
        (sine > IN_PLANE).then(|| Self { ends, far, hidden: normal / sine, face })
    }

    /// Box around its directions.
    pub fn span(&self) -> Span {
        Span::over(self.ends.iter().map(|end| end.as_vec3a()))
    }

    /// The direction of its middle.
    pub fn middle(&self) -> DVec3 {
        (self.ends[0] + self.ends[1]).normalize()
    }

    /// Chord between the directions of its ends.
    pub fn length(&self) -> f64 {
        (self.ends[0] - self.ends[1]).length()
    }

    /// Where along the segment, 0..1, it is seen in `direction`, which lies in its plane; none if beyond its ends.
    pub fn share_at(&self, direction: DVec3) -> Option<f64> {
        let [a, b] = self.ends;
        let (before, beyond) = (direction.cross(a).dot(self.hidden), b.cross(direction).dot(self.hidden));
        // These are shares of the chord between unit vectors; those of the segment follow after division by the distances.
        let (to_b, to_a) = (before / self.far[1], beyond / self.far[0]);
        (before > 0.0 && beyond > 0.0).then(|| to_b / (to_a + to_b))
    }

    /// The piece between two shares of the segment; none if they are the same but for rounding.
    pub fn piece(&self, from: f64, to: f64) -> Option<Self> {
        let mut piece = *self;
        if from != 0.0 {
            piece.move_end(0, self, from);
        }
        if to != 1.0 {
            piece.move_end(1, self, to);
        }
        (piece.length() > IN_PLANE).then_some(piece)
    }

    /// The piece on the positive side of the plane with unit normal `plane` through the receiver's point. Ends within
    /// [`IN_PLANE`] of the plane lie on both sides; an arc in the plane on none.
    pub fn clip(&self, plane: DVec3) -> Option<Self> {
        let sines = self.ends.map(|end| plane.dot(end));
        if sines[0].max(sines[1]) <= IN_PLANE {
            return None;
        }
        Some(self.keep_above([sines[0] * self.far[0], sines[1] * self.far[1]]))
    }

    /// The piece that `height`, an affine function of the point, lifts above zero; none if it nowhere exceeds `slack`.
    pub fn above(&self, height: impl Fn(DVec3) -> f64, slack: f64) -> Option<Self> {
        let heights = [0, 1].map(|i| height(self.ends[i] * self.far[i]));
        (heights[0].max(heights[1]) > slack).then(|| self.keep_above(heights))
    }

    /// The piece above zero, where one of the ends' heights is.
    fn keep_above(&self, heights: [f64; 2]) -> Self {
        let mut piece = *self;
        if heights[0].min(heights[1]) < 0.0 {
            let lower = usize::from(heights[1] < 0.0);
            piece.move_end(lower, self, heights[0] / (heights[0] - heights[1]));
        }
        piece
    }

    fn move_end(&mut self, end: usize, of: &Self, share: f64) {
        let [a, b] = [of.ends[0] * of.far[0], of.ends[1] * of.far[1]];
        let point = a + (b - a) * share;
        self.far[end] = point.length();
        self.ends[end] = point / self.far[end];
    }
}
