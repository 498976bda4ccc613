//! The contour sum for many receivers at once: the same polygon seen from the points of one flat cluster.
//!
//! With unit vectors a, b to an edge's ends, θ n·(a×b)/|a×b| = n·(a×b) · g(a·b), where g(c) = acos(c)/√(1−c²) is smooth
//! on (−1, 1]: no cross product is normalised and no arc tangent taken. All loops run over lanes of plain arrays, which
//! the compiler turns into vector instructions. [`super::contour`] is the plain version.

use super::contour;
use glam::DVec3;
use std::f64::consts::PI;

/// Receivers that are worked on together.
pub const LANES: usize = 8;

/// One number a lane.
type Lane = [f64; LANES];

/// Cosines below this belong to edges that pass close by a receiver: there g is steep, and the plain contour is taken.
const STEEP: f64 = -0.98;

/// Points of receivers that look along the same normal, padded with the last to whole lanes.
pub struct Points {
    lanes: Vec<[Lane; 3]>,
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

    /// The normal they share.
    pub fn normal(&self) -> DVec3 {
        self.normal
    }

    /// Append to `values` the form factor of the unoccluded polygon `corners` (scene coordinates, counter-clockwise from
    /// its front, above the common horizon) for every point.
    pub fn form_factors(&self, corners: &[DVec3], values: &mut Vec<f64>) {
        let first = values.len();
        for lanes in &self.lanes {
            let (sum, lowest) = contours(lanes, corners, self.normal);
            for lane in 0..LANES.min(self.points.len() + first - values.len()) {
                let point = self.points[values.len() - first];
                let plain = lowest[lane] < STEEP || is_far(point, corners);
                values.push(if plain { self.plain(point, corners) } else { sum[lane] });
            }
        }
    }

    fn plain(&self, point: DVec3, corners: &[DVec3]) -> f64 {
        let polygon: super::polygon::Polygon = corners.iter().map(|&p| p - point).collect();
        contour::form_factor(&polygon, self.normal)
    }
}

/// Beyond this the plain version integrates by a Gauss rule.
fn is_far(point: DVec3, corners: &[DVec3]) -> bool {
    let reach = (corners[0] - point).length_squared();
    let size = (corners[0] - corners[corners.len() / 2]).length_squared();
    reach > size * (contour::FAR * contour::FAR) * 0.25
}

/// The contour sum, and the lowest cosine between neighbouring corners, of every lane.
fn contours(points: &[Lane; 3], corners: &[DVec3], normal: DVec3) -> (Lane, Lane) {
    let (mut sum, mut lowest) = ([0.0; LANES], [1.0; LANES]);
    let first = directions(points, corners[0]);
    let mut a = first;
    for k in 1..=corners.len() {
        let b = if k == corners.len() { first } else { directions(points, corners[k]) };
        for lane in 0..LANES {
            let (ax, ay, az) = (a[0][lane], a[1][lane], a[2][lane]);
            let (bx, by, bz) = (b[0][lane], b[1][lane], b[2][lane]);
            let cosine = ax * bx + ay * by + az * bz;
            let triple = normal.x * (ay * bz - az * by)
                + normal.y * (az * bx - ax * bz)
                + normal.z * (ax * by - ay * bx);
            lowest[lane] = if cosine < lowest[lane] { cosine } else { lowest[lane] };
            sum[lane] += triple * angle_over_sine(cosine);
        }
        a = b;
    }
    (sum.map(|s| -s / (2.0 * PI)), lowest)
}

/// Unit vectors from the points to a corner.
fn directions(points: &[Lane; 3], corner: DVec3) -> [Lane; 3] {
    let mut d = [[0.0; LANES]; 3];
    for lane in 0..LANES {
        let (x, y, z) = (corner.x - points[0][lane], corner.y - points[1][lane], corner.z - points[2][lane]);
        let inverse = 1.0 / (x * x + y * y + z * z).sqrt();
        d[0][lane] = x * inverse;
        d[1][lane] = y * inverse;
        d[2][lane] = z * inverse;
    }
    d
}

/// g(c) = acos(c)/√(1−c²). For c ≥ 0 a polynomial; for c < 0, g(c) = π/√(1−c²) − g(−c).
#[inline(always)]
fn angle_over_sine(cosine: f64) -> f64 {
    let t = 2.0 * cosine.abs() - 1.0;
    let mut sum = G[G.len() - 1];
    for k in (0..G.len() - 1).rev() {
        sum = sum * t + G[k];
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
