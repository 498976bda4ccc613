//! The contour sum for many receivers at once: the same polygon seen from the points of one flat cluster.
//!
//! With unit vectors a, b to an edge's ends, θ n·(a×b)/|a×b| = n·(a×b) · g(a·b), where g(c) = acos(c)/√(1−c²) is smooth
//! on (−1, 1]: no cross product is normalised and no arc tangent computed. All loops run over lanes of plain arrays, which
//! the compiler turns into vector instructions where they are inlined into [`vectorised`]. [`super::contour`] is the
//! plain version.

use glam::DVec3;
use std::f64::consts::PI;

/// Receivers computed together.
pub const LANES: usize = 8;

/// One number a lane.
pub type Lane = [f64; LANES];

/// One vector a lane, by coordinate.
pub type Vectors = [Lane; 3];

/// Smaller cosines belong to edges that pass close to a receiver. There g is steep, and the plain contour is used.
pub const STEEP: f64 = -0.98;

/// Runs `kernel` with the widest vector instructions of this machine. Results do not depend on them: fused
/// multiplications are explicit, and emulated on machines without them.
pub fn vectorised<R>(kernel: impl FnOnce() -> R) -> R {
    pulp::Arch::new().dispatch(kernel)
}

/// Points of receivers with the same normal, padded to whole lanes with the last point.
#[derive(Debug)]
pub struct Points {
    lanes: Vec<Vectors>,
    points: Vec<DVec3>,
    normal: DVec3,
}

impl Points {
    /// The points of receivers with the unit normal `normal`; at least one.
    pub fn new(points: Vec<DVec3>, normal: DVec3) -> Self {
        let lanes = points
            .chunks(LANES)
            .map(|chunk| {
                let at = |lane: usize| chunk[lane.min(chunk.len() - 1)];
                [0, 1, 2].map(|axis| std::array::from_fn(|lane| at(lane)[axis]))
            })
            .collect();
        Self { lanes, points, normal }
    }

    /// The points.
    pub fn points(&self) -> &[DVec3] {
        &self.points
    }

    /// The points, [`LANES`] at a time.
    pub fn lanes(&self) -> &[Vectors] {
        &self.lanes
    }

    /// The unit normal of all receivers.
    pub fn normal(&self) -> DVec3 {
        self.normal
    }
}

/// Vectors from the points to a corner.
#[inline(always)]
pub fn towards(corner: DVec3, points: &Vectors) -> Vectors {
    let mut d = [[0.0; LANES]; 3];
    for lane in 0..LANES {
        d[0][lane] = corner.x - points[0][lane];
        d[1][lane] = corner.y - points[1][lane];
        d[2][lane] = corner.z - points[2][lane];
    }
    d
}

/// |v|² of every lane.
#[inline(always)]
pub fn squared(v: &Vectors) -> Lane {
    let mut sum = [0.0; LANES];
    for lane in 0..LANES {
        let (x, y, z) = (v[0][lane], v[1][lane], v[2][lane]);
        sum[lane] = x.mul_add(x, y.mul_add(y, z * z));
    }
    sum
}

/// The contour sum over `corners`, given relative to each point, and the lowest cosine between neighbouring corners, of
/// every lane. Corners are counter-clockwise from the sender's front, as for [`super::contour::contour`].
#[inline(always)]
pub fn contours(corners: &[Vectors], normal: DVec3) -> (Lane, Lane) {
    let (mut sum, mut lowest) = ([0.0; LANES], [1.0; LANES]);
    let mut a = unit(&corners[corners.len() - 1]);
    for corner in corners {
        let b = unit(corner);
        for lane in 0..LANES {
            let (ax, ay, az) = (a[0][lane], a[1][lane], a[2][lane]);
            let (bx, by, bz) = (b[0][lane], b[1][lane], b[2][lane]);
            let cosine = ax.mul_add(bx, ay.mul_add(by, az * bz));
            let (x, y, z) = (ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx);
            let triple = normal.x.mul_add(x, normal.y.mul_add(y, normal.z * z));
            lowest[lane] = if cosine < lowest[lane] { cosine } else { lowest[lane] };
            sum[lane] += triple * angle_over_sine(cosine);
        }
        a = b;
    }
    (sum.map(|s| -s / (2.0 * PI)), lowest)
}

#[inline(always)]
fn unit(v: &Vectors) -> Vectors {
    let mut d = [[0.0; LANES]; 3];
    let length2 = squared(v);
    for lane in 0..LANES {
        let inverse = 1.0 / length2[lane].sqrt();
        d[0][lane] = v[0][lane] * inverse;
        d[1][lane] = v[1][lane] * inverse;
        d[2][lane] = v[2][lane] * inverse;
    }
    d
}

/// g(c) = acos(c)/√(1−c²). For c ≥ 0 a polynomial; for c < 0, g(c) = π/√(1−c²) − g(−c).
#[inline(always)]
pub fn angle_over_sine(cosine: f64) -> f64 {
    let t = cosine.abs().mul_add(2.0, -1.0);
    let mut sum = G[G.len() - 1];
    for k in (0..G.len() - 1).rev() {
        sum = sum.mul_add(t, G[k]);
    }
    let obtuse = PI / (1.0 - cosine * cosine).sqrt() - sum;
    if cosine < 0.0 { obtuse } else { sum }
}

/// g on [0, 1] in powers of t = 2c − 1: its Chebyshev series (interpolated at 120 points in 60 digits) up to degree 21,
/// where the terms fall below 4e-17.
const G: [f64; 22] = [
    1.2091995761561452,
    -0.26360014128128495,
    0.06973319205204692,
    -0.019837146922478774,
    0.00586162897495759,
    -0.0017729284611099334,
    0.0005447739881301811,
    -0.00016930994739062122,
    5.307370323056482e-05,
    -1.6749143247281873e-05,
    5.314287188091921e-06,
    -1.693639120851007e-06,
    5.418581985727714e-07,
    -1.7388548997694832e-07,
    5.575738842888287e-08,
    -1.7964789574344403e-08,
    6.0331600097782334e-09,
    -1.966661891855127e-09,
    4.681011903625551e-10,
    -1.4602825315849918e-10,
    1.1890151456850346e-10,
    -3.984620360291936e-11,
];
