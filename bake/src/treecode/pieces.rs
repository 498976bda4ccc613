//! Convex pieces of a sender as seen by one receiver, and the subtraction of pyramids from them. Points are relative to
//! the receiver, so a plane of a pyramid is given by its normal.

use glam::DVec3;

/// A list of convex polygons with contiguous storage.
#[derive(Default)]
pub struct Pieces {
    points: Vec<DVec3>,
    ends: Vec<usize>,
}

impl Pieces {
    /// Removes all polygons.
    pub fn clear(&mut self) {
        self.points.clear();
        self.ends.clear();
    }

    /// Adds a polygon.
    pub fn push(&mut self, polygon: &[DVec3]) {
        self.points.extend_from_slice(polygon);
        self.ends.push(self.points.len());
    }

    /// The polygons.
    pub fn iter(&self) -> impl Iterator<Item = &[DVec3]> {
        let starts = std::iter::once(0).chain(self.ends.iter().copied());
        starts.zip(&self.ends).map(|(start, &end)| &self.points[start..end])
    }
}

/// Subtracts pyramids from polygons, with reusable buffers.
#[derive(Default)]
pub struct Scissors {
    inside: Vec<DVec3>,
    rest: Vec<DVec3>,
    distances: Vec<f64>,
}

impl Scissors {
    /// Appends to `outside` the pieces of `polygon` that a pyramid does not hide. Corners within `slack` of a plane
    /// count as in it, so that two pyramids that share a plane leave no sliver between them.
    pub fn subtract(
        &mut self,
        polygon: &[DVec3],
        planes: impl Iterator<Item = DVec3> + Clone,
        slack: f64,
        outside: &mut Pieces,
    ) {
        // What lies wholly behind one plane stays in one piece.
        if planes.clone().any(|plane| polygon.iter().all(|p| plane.dot(*p) <= slack)) {
            outside.push(polygon);
            return;
        }
        self.inside.clear();
        self.inside.extend_from_slice(polygon);
        for plane in planes {
            match self.place(plane, slack) {
                PlaneSide::Inside => {}
                PlaneSide::Outside => return outside.push(&self.inside),
                PlaneSide::Across => {
                    outside.points.reserve(self.inside.len() + 1);
                    self.half(-1.0, |p| outside.points.push(p));
                    outside.ends.push(outside.points.len());
                    self.keep();
                }
            }
        }
    }

    /// The piece of `polygon` inside a pyramid; empty if there is none. `slack` as above.
    pub fn intersect(
        &mut self,
        polygon: &[DVec3],
        planes: impl Iterator<Item = DVec3>,
        slack: f64,
    ) -> &[DVec3] {
        self.inside.clear();
        self.inside.extend_from_slice(polygon);
        for plane in planes {
            match self.place(plane, slack) {
                PlaneSide::Inside => {}
                PlaneSide::Outside => return &[],
                PlaneSide::Across => self.keep(),
            }
        }
        &self.inside
    }

    /// The side of one more plane on which the inside polygon lies.
    fn place(&mut self, plane: DVec3, slack: f64) -> PlaneSide {
        self.distances.clear();
        let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
        for p in &self.inside {
            let distance = plane.dot(*p);
            low = if distance < low { distance } else { low };
            high = if distance > high { distance } else { high };
            self.distances.push(distance);
        }
        if low >= -slack {
            PlaneSide::Inside
        } else if high <= slack {
            PlaneSide::Outside
        } else {
            PlaneSide::Across
        }
    }

    /// Cuts off what lies behind the plane.
    fn keep(&mut self) {
        let mut rest = std::mem::take(&mut self.rest);
        rest.clear();
        rest.reserve(self.inside.len() + 1);
        self.half(1.0, |p| rest.push(p));
        self.rest = std::mem::replace(&mut self.inside, rest);
    }

    /// The corners of one half. Corners on the plane belong to both; cut points lie between the corners that they come
    /// from, and are the same for both halves.
    #[inline(always)]
    fn half(&self, sign: f64, mut corner: impl FnMut(DVec3)) {
        let last = self.inside.len() - 1;
        let (mut p, mut dp) = (self.inside[last], self.distances[last]);
        for (&q, &dq) in self.inside.iter().zip(&self.distances) {
            if dp * dq < 0.0 {
                corner(p + (q - p) * (dp / (dp - dq)));
            }
            if dq * sign >= 0.0 {
                corner(q);
            }
            (p, dp) = (q, dq);
        }
    }
}

/// The side of a plane on which a polygon lies.
enum PlaneSide {
    Inside,
    Outside,
    Across,
}
