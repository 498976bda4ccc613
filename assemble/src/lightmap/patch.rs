//! Affine maps between texel coordinates and points of a plane.

use glam::{DAffine3, DVec2, DVec3, dvec2};

/// A region of a plane with texel coordinates: (x, y) is the point `origin` + x·`du` + y·`dv`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Patch {
    /// The corner of the grid, metres.
    pub origin: DVec3,
    /// One texel along a row, metres.
    pub du: DVec3,
    /// One texel along a column, metres.
    pub dv: DVec3,
    /// Unit normal of the lit side.
    pub normal: DVec3,
}

impl Patch {
    /// The point at a texel's coordinates, metres.
    pub fn point(&self, texel: DVec2) -> DVec3 {
        self.origin + self.du * texel.x + self.dv * texel.y
    }

    /// The patch transformed by `placement`, a similarity.
    pub fn placed(&self, placement: DAffine3) -> Self {
        let vector = |v| placement.transform_vector3(v);
        Self {
            origin: placement.transform_point3(self.origin),
            du: vector(self.du),
            dv: vector(self.dv),
            normal: vector(self.normal).normalize(),
        }
    }

    /// The longest distance in the plane that one texel covers, metres: the larger singular value of (du dv).
    pub fn stretch(&self) -> f64 {
        let (a, b, c) = (self.du.length_squared(), self.du.dot(self.dv), self.dv.length_squared());
        ((a + c) / 2.0 + ((a - c) / 2.0).hypot(b)).sqrt()
    }
}

/// A patch and its inverse: the texel of a point p is (p·`to[0]`, p·`to[1]`) + `at`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Map {
    to: [DVec3; 2],
    at: DVec2,
    /// From texels to points.
    pub patch: Patch,
}

impl Map {
    /// The map that projects along `direction` (unit) onto the unit vectors `axes` across it. Texels are `step`
    /// metres apart; the point at `low` along the axes gets the texel coordinates `first`. The plane contains
    /// `point`.
    pub fn along(
        direction: DVec3,
        axes: [DVec3; 2],
        [low, step, first]: [DVec2; 3],
        point: DVec3,
        normal: DVec3,
    ) -> Self {
        let onto = |p: DVec3| p - direction * (p.dot(normal) / normal.dot(direction));
        let corner = low - step * first;
        let flat = axes[0] * corner.x + axes[1] * corner.y;
        let patch = Patch {
            origin: point + onto(flat - point),
            du: onto(axes[0]) * step.x,
            dv: onto(axes[1]) * step.y,
            normal,
        };
        Self { to: [axes[0] / step.x, axes[1] / step.y], at: first - low / step, patch }
    }

    /// The map from three corners to their positions, unless either lie on a line.
    pub fn through(corners: [DVec3; 3], places: [DVec2; 3], normal: DVec3) -> Option<Self> {
        let [e, f] = [1, 2].map(|i| corners[i] - corners[0]);
        let [s, t] = [1, 2].map(|i| places[i] - places[0]);
        let area = s.perp_dot(t);
        let (du, dv) = ((e * t.y - f * s.y) / area, (f * s.x - e * t.x) / area);
        let (a, b, c) = (du.length_squared(), du.dot(dv), dv.length_squared());
        let determinant = a * c - b * b;
        let to = [(du * c - dv * b) / determinant, (dv * a - du * b) / determinant];
        let origin = corners[0] - du * places[0].x - dv * places[0].y;
        let at = places[0] - dvec2(corners[0].dot(to[0]), corners[0].dot(to[1]));
        let map = Self { to, at, patch: Patch { origin, du, dv, normal } };
        let finite = origin.is_finite() && to.iter().all(|row| row.is_finite());
        (finite && determinant > 0.0).then_some(map)
    }

    /// The texel coordinates of a point.
    pub fn texel_of(&self, point: DVec3) -> DVec2 {
        dvec2(point.dot(self.to[0]), point.dot(self.to[1])) + self.at
    }

    /// The map with `count` times as many texels in each direction, starting at `first`.
    pub fn scaled(&self, count: f64, first: DVec2) -> Self {
        let Patch { origin, du, dv, normal } = self.patch;
        let (du, dv) = (du / count, dv / count);
        let patch = Patch { origin: origin - du * first.x - dv * first.y, du, dv, normal };
        Self { to: self.to.map(|row| row * count), at: self.at * count + first, patch }
    }
}
