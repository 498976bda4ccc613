//! The region between a cluster of receivers and a sender: whatever lies outside it cannot stand in between.
//!
//! Planes through corners of the two boxes bound the boxes' convex hull from outside (Haines & Wallace 1994), together
//! with the receivers' horizon and the plane of a flat sender. Conservative: what is called outside is outside.

use glam::DVec3;

/// A convex region around everything between two boxes.
pub struct Shaft {
    low: DVec3,
    high: DVec3,
    /// Outward normal and offset: outside is where n·p ≥ d.
    planes: Vec<(DVec3, f64)>,
}

/// A box by its lowest and highest corner.
pub type Bounds = (DVec3, DVec3);

impl Shaft {
    /// The shaft between two boxes.
    pub fn between(a: Bounds, b: Bounds) -> Self {
        let mut shaft = Self { low: a.0.min(b.0), high: a.1.max(b.1), planes: Vec::with_capacity(8) };
        for (u, v) in [(0, 1), (0, 2), (1, 2)] {
            for (up_u, up_v) in [(false, false), (false, true), (true, false), (true, true)] {
                shaft.bridge(a, b, (u, up_u), (v, up_v));
            }
        }
        shaft
    }

    /// Nothing on the far side of the plane through `point` with normal `outwards` matters.
    pub fn bound(&mut self, point: DVec3, outwards: DVec3) {
        self.planes.push((outwards, outwards.dot(point)));
    }

    /// In the plane of axes u and v, the line from a corner of `a` to the same corner of `b` bounds both boxes if each
    /// box reaches further in one of the two directions.
    fn bridge(&mut self, a: Bounds, b: Bounds, (u, up_u): (usize, bool), (v, up_v): (usize, bool)) {
        let corner = |b: Bounds, axis: usize, up: bool| if up { b.1[axis] } else { b.0[axis] };
        let (pu, pv) = (corner(a, u, up_u), corner(a, v, up_v));
        let (qu, qv) = (corner(b, u, up_u), corner(b, v, up_v));
        let further = |p: f64, q: f64, up: bool| if up { p > q } else { p < q };
        let first = further(pu, qu, up_u) && further(qv, pv, up_v);
        let second = further(qu, pu, up_u) && further(pv, qv, up_v);
        if !(first || second) {
            return;
        }
        let sign = |up: bool| if up { 1.0 } else { -1.0 };
        let mut normal = DVec3::ZERO;
        normal[u] = sign(up_u) * (qv - pv).abs();
        normal[v] = sign(up_v) * (qu - pu).abs();
        self.planes.push((normal, normal[u] * pu + normal[v] * pv));
    }

    /// Whether a box lies outside.
    pub fn misses_box(&self, low: DVec3, high: DVec3) -> bool {
        if low.cmpge(self.high).any() || high.cmple(self.low).any() {
            // A flat thing in a side of the region only touches it, unless the region itself is flat there.
            let flat = self.low.cmpeq(self.high);
            let apart = (low.cmpge(self.high) & !flat).any()
                || (high.cmple(self.low) & !flat).any()
                || low.cmpgt(self.high).any()
                || high.cmplt(self.low).any();
            if apart {
                return true;
            }
        }
        let (centre, half) = ((low + high) * 0.5, (high - low) * 0.5);
        self.planes.iter().any(|&(normal, offset)| normal.dot(centre) - normal.abs().dot(half) >= offset)
    }

    /// Whether the convex hull of `corners` lies outside.
    pub fn misses(&self, corners: &[DVec3]) -> bool {
        self.planes.iter().any(|&(normal, offset)| corners.iter().all(|p| normal.dot(*p) >= offset))
    }
}
