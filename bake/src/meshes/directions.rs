//! An index over directions: a tree of boxes around unit vectors, with fixed structure.
//!
//! Neighbouring items of the list are near each other, so the boxes around a few consecutive items are small, and so
//! are the boxes around a few consecutive boxes. Boxes are f32, rounded outwards; callers test the results exactly.

use crate::geometry::tolerance::DIRECTION_MARGIN;
use glam::{DVec3, Vec3A, Vec4};

/// A box around directions from a point, as unit vectors.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Span {
    low: Vec3A,
    high: Vec3A,
}

impl Span {
    /// The empty box.
    pub const EMPTY: Self = Self { low: Vec3A::INFINITY, high: Vec3A::NEG_INFINITY };

    /// The box around every direction in the convex cone that these unit vectors span.
    ///
    /// A point p in the convex hull of unit vectors with chords of at most c has |p|² ≥ 1 − c²/2, so p/|p| lies within
    /// the hull's box stretched by (1 − c²/2)^−½ ≤ 1 + c²/2 (for c ≤ 1).
    pub fn over(directions: impl Iterator<Item = Vec3A>) -> Self {
        let (low, high) =
            directions.fold((Vec3A::INFINITY, Vec3A::NEG_INFINITY), |(l, h), d| (l.min(d), h.max(d)));
        let chord2 = (high - low).length_squared();
        if chord2 > 0.99 {
            return Self { low: Vec3A::splat(-2.0), high: Vec3A::splat(2.0) };
        }
        let stretch = 1.0 + chord2 / 2.0;
        Self {
            low: low.min(low * stretch) - DIRECTION_MARGIN,
            high: high.max(high * stretch) + DIRECTION_MARGIN,
        }
    }

    /// The box around this one direction.
    pub fn at(direction: DVec3) -> Self {
        let direction = direction.as_vec3a();
        Self { low: direction - DIRECTION_MARGIN, high: direction + DIRECTION_MARGIN }
    }

    /// Whether the boxes have a point in common.
    pub fn meets(&self, other: &Self) -> bool {
        (self.low.cmple(other.high) & other.low.cmple(self.high)).all()
    }
}

/// Children of each box: as many as one vector comparison covers.
const LANES: usize = 4;

/// Neighbouring boxes by coordinate, one a lane.
#[derive(Debug, Clone, Copy)]
struct SpanLanes {
    low: [Vec4; 3],
    high: [Vec4; 3],
}

impl SpanLanes {
    /// The lanes of at most [`LANES`] spans; remaining lanes are empty.
    fn new(spans: &[Span]) -> Self {
        let at = |lane: usize| spans.get(lane).unwrap_or(&Span::EMPTY);
        let lanes = |value: fn(&Span) -> f32| Vec4::from_array(std::array::from_fn(|lane| value(at(lane))));
        Self {
            low: [lanes(|s| s.low[0]), lanes(|s| s.low[1]), lanes(|s| s.low[2])],
            high: [lanes(|s| s.high[0]), lanes(|s| s.high[1]), lanes(|s| s.high[2])],
        }
    }

    fn whole(&self) -> Span {
        Span { low: self.low.map(Vec4::min_element).into(), high: self.high.map(Vec4::max_element).into() }
    }

    /// The lanes that meet `sought`, one bit each.
    fn meeting(&self, sought: &Span) -> u32 {
        let along = |axis: usize| {
            self.low[axis].cmple(Vec4::splat(sought.high[axis]))
                & self.high[axis].cmpge(Vec4::splat(sought.low[axis]))
        };
        (along(0) & along(1) & along(2)).bitmask()
    }
}

/// An index over the spans of many items.
#[derive(Debug, Default)]
pub struct Spans {
    /// The items' own spans in groups of lanes, then the spans around those groups, and so on up to a single group.
    levels: Vec<Vec<SpanLanes>>,
}

impl Spans {
    /// The index over items with these spans; neighbours in the list should be near each other.
    pub fn new(things: &[Span]) -> Self {
        let mut levels = Vec::new();
        let mut spans;
        let mut below = things;
        while !below.is_empty() {
            let runs: Vec<SpanLanes> = below.chunks(LANES).map(SpanLanes::new).collect();
            spans = if runs.len() == 1 {
                vec![]
            } else {
                runs.iter().map(SpanLanes::whole).collect::<Vec<Span>>()
            };
            levels.push(runs);
            below = &spans;
        }
        Self { levels }
    }

    /// The box around everything.
    pub fn whole(&self) -> Span {
        self.levels.last().map_or(Span::EMPTY, |top| top[0].whole())
    }

    /// Calls `found` with the items whose spans meet `sought`, in order, until it returns true. Returns whether it did.
    pub fn any(&self, sought: &Span, mut found: impl FnMut(usize) -> bool) -> bool {
        !self.levels.is_empty() && self.any_of(self.levels.len() - 1, 0, sought, &mut found)
    }

    fn any_of(&self, level: usize, run: usize, sought: &Span, found: &mut impl FnMut(usize) -> bool) -> bool {
        let mut meeting = self.levels[level][run].meeting(sought);
        while meeting != 0 {
            let index = run * LANES + meeting.trailing_zeros() as usize;
            meeting &= meeting - 1;
            if if level == 0 { found(index) } else { self.any_of(level - 1, index, sought, found) } {
                return true;
            }
        }
        false
    }
}
