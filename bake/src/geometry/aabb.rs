//! Axis-aligned boxes.

use super::polygon::Polygon;
use glam::DVec3;
use std::borrow::Borrow;

/// An axis-aligned box, metres. Empty if any coordinate of `low` is above that of `high`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Aabb {
    /// Lowest corner.
    pub low: DVec3,
    /// Highest corner.
    pub high: DVec3,
}

impl Aabb {
    /// The box that holds nothing.
    pub const EMPTY: Self = Self { low: DVec3::INFINITY, high: DVec3::NEG_INFINITY };

    /// The smallest box around points.
    pub fn around<P: Borrow<DVec3>>(points: impl IntoIterator<Item = P>) -> Self {
        points.into_iter().fold(Self::EMPTY, |all, p| {
            let p = *p.borrow();
            Self { low: all.low.min(p), high: all.high.max(p) }
        })
    }

    /// The smallest box around this one and another.
    #[inline(always)]
    pub fn union(self, other: Self) -> Self {
        Self { low: self.low.min(other.low), high: self.high.max(other.high) }
    }

    /// The box moved by a vector.
    pub fn moved(self, by: DVec3) -> Self {
        Self { low: self.low + by, high: self.high + by }
    }

    /// The box enlarged by `by` on all sides.
    pub fn grown(self, by: f64) -> Self {
        Self { low: self.low - by, high: self.high + by }
    }

    /// Whether it contains no point.
    pub fn is_empty(&self) -> bool {
        self.low.cmpgt(self.high).any()
    }

    /// Its middle.
    #[inline(always)]
    pub fn centre(&self) -> DVec3 {
        (self.low + self.high) * 0.5
    }

    /// Its extent along each axis.
    #[inline(always)]
    pub fn size(&self) -> DVec3 {
        self.high - self.low
    }

    /// The distance between its lowest and highest corner.
    #[inline(always)]
    pub fn diagonal(&self) -> f64 {
        self.size().length()
    }

    /// Its eight corners.
    pub fn corners(&self) -> Polygon {
        (0..8)
            .map(|k| {
                let pick = |bit: usize, axis: usize| {
                    if k >> bit & 1 == 0 { self.low[axis] } else { self.high[axis] }
                };
                DVec3::new(pick(0, 0), pick(1, 1), pick(2, 2))
            })
            .collect()
    }

    /// Whether a point lies inside or on it.
    pub fn holds(&self, point: DVec3) -> bool {
        point.cmpge(self.low).all() && point.cmple(self.high).all()
    }

    /// Whether the two have a point in common.
    pub fn meets(&self, other: &Self) -> bool {
        (self.low.cmple(other.high) & other.low.cmple(self.high)).all()
    }
}
