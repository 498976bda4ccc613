//! The region between a cluster of receivers and a sender: objects outside it cannot occlude.
//!
//! Planes through corners of the two boxes bound the boxes' convex hull from outside (Haines & Wallace 1994), together
//! with the receivers' horizon and the plane of a flat sender. Conservative: objects reported as outside are outside.

use super::aabb::Aabb;
use glam::DVec3;

/// Number of planes of a region: four bridges for each pair of axes, the horizon, the sender's plane, and two spare ones.
const PLANES: usize = 16;

/// For each bridge the two axes of its plane, and whether it lies up or down them.
const BRIDGES: [(usize, usize, f64, f64); 12] = {
    let mut bridges = [(0, 0, 0.0, 0.0); 12];
    let (axes, ways) = ([(0, 1), (0, 2), (1, 2)], [(1.0, 1.0), (1.0, -1.0), (-1.0, 1.0), (-1.0, -1.0)]);
    let mut k = 0;
    while k < 12 {
        bridges[k] = (axes[k / 4].0, axes[k / 4].1, ways[k % 4].0, ways[k % 4].1);
        k += 1;
    }
    bridges
};

/// A convex region around everything between two boxes.
#[derive(Debug)]
pub struct Shaft {
    around: Aabb,
    /// Outward normals by coordinate, and offsets: outside is where n·p ≥ d. Unused ones have no outside.
    normals: [[f64; PLANES]; 3],
    offsets: [f64; PLANES],
    count: usize,
}

impl Shaft {
    /// The shaft between two boxes.
    #[inline(always)]
    pub fn between(a: Aabb, b: Aabb) -> Self {
        let mut shaft = Self {
            around: a.union(b),
            normals: [[0.0; PLANES]; 3],
            offsets: [f64::INFINITY; PLANES],
            count: BRIDGES.len(),
        };
        let (a, b) = ([a.low, a.high].map(|p| p.to_array()), [b.low, b.high].map(|p| p.to_array()));
        for (k, &(u, v, up_u, up_v)) in BRIDGES.iter().enumerate() {
            shaft.bridge(k, a, b, (u, up_u), (v, up_v));
        }
        shaft
    }

    /// Nothing on the far side of the plane through `point` with normal `outwards` matters. At most four such planes.
    pub fn bound(&mut self, point: DVec3, outwards: DVec3) {
        for axis in 0..3 {
            self.normals[axis][self.count] = outwards[axis];
        }
        self.offsets[self.count] = outwards.dot(point);
        self.count += 1;
    }

    /// In the plane of axes u and v, the line from a corner of `a` to the same corner of `b` bounds both boxes if each
    /// box reaches further in one of the two directions.
    #[inline(always)]
    fn bridge(
        &mut self,
        k: usize,
        a: [[f64; 3]; 2],
        b: [[f64; 3]; 2],
        (u, up_u): (usize, f64),
        (v, up_v): (usize, f64),
    ) {
        let side = |up: f64| usize::from(up > 0.0);
        let (pu, pv) = (a[side(up_u)][u], a[side(up_v)][v]);
        let (qu, qv) = (b[side(up_u)][u], b[side(up_v)][v]);
        // How much further the first box reaches along u, and the second along v: of one sign where there is a bridge.
        let (along_u, along_v) = ((pu - qu) * up_u, (qv - pv) * up_v);
        let is_bridge = ((along_u > 0.0) & (along_v > 0.0)) | ((along_u < 0.0) & (along_v < 0.0));
        let (nu, nv) = (up_u * along_v.abs(), up_v * along_u.abs());
        self.normals[u][k] = nu;
        self.normals[v][k] = nv;
        self.offsets[k] = if is_bridge { nu * pu + nv * pv } else { f64::INFINITY };
    }

    /// Whether a box lies outside.
    #[inline(always)]
    pub fn misses_box(&self, &Aabb { low, high }: &Aabb) -> bool {
        let around = &self.around;
        if low.cmpge(around.high).any() || high.cmple(around.low).any() {
            // A flat box in a side of the region only touches it, unless the region itself is flat there.
            let flat = around.low.cmpeq(around.high);
            let apart = (low.cmpge(around.high) & !flat).any()
                || (high.cmple(around.low) & !flat).any()
                || low.cmpgt(around.high).any()
                || high.cmplt(around.low).any();
            if apart {
                return true;
            }
        }
        let (centre, half) = ((low + high) * 0.5, (high - low) * 0.5);
        let [nx, ny, nz] = &self.normals;
        let mut outside = false;
        for k in 0..PLANES {
            let nearest = (nx[k] * centre.x - nx[k].abs() * half.x)
                + (ny[k] * centre.y - ny[k].abs() * half.y)
                + (nz[k] * centre.z - nz[k].abs() * half.z);
            outside |= nearest >= self.offsets[k];
        }
        outside
    }

    /// Whether the convex hull of `corners` lies outside.
    #[inline(always)]
    pub fn misses(&self, corners: &[DVec3]) -> bool {
        let [nx, ny, nz] = &self.normals;
        let mut nearest = [f64::INFINITY; PLANES];
        for p in corners {
            for (k, nearest) in nearest.iter_mut().enumerate() {
                let along = nx[k] * p.x + ny[k] * p.y + nz[k] * p.z;
                *nearest = if along < *nearest { along } else { *nearest };
            }
        }
        let mut outside = false;
        for (nearest, offset) in nearest.iter().zip(&self.offsets) {
            outside |= nearest >= offset;
        }
        outside
    }
}
