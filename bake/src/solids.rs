//! The closed solids of a part, and which points lie inside them. In go faces, out come solids, in the part's coordinates.
//!
//! A solid is a shell of faces that look outwards. How often a shell goes around a point is the sum of the solid angles of its
//! faces over 4π: 1 inside, 0 outside, whatever its shape (Jacobson, Kavan & Sorkine-Hornung 2013). A room, whose faces look
//! inwards, is none; nor is what is open somewhere, or what shines or reflects on both sides.

use equilux_formats::{Face, Geometry};
use glam::DVec3;
use std::collections::HashMap;
use std::f64::consts::PI;

/// A closed shell of faces that look outwards.
pub struct Solid {
    /// Lowest corner of its box.
    pub low: DVec3,
    /// Highest corner of its box.
    pub high: DVec3,
    /// Its faces, sorted.
    pub faces: Vec<u32>,
}

/// How far the sum of a closed shell's areas, as vectors, may be from zero, relative to their sum as numbers: corners that
/// several faces share are equal to the bit, but for those that lie on another's edge.
const CLOSED: f64 = 1e-6;

/// How far from 1 the winding number of a point inside may be; on a face it is ½.
const AROUND: f64 = 1e-3;

/// The solids of a part.
pub fn solids(geometry: &Geometry) -> Vec<Solid> {
    let two_sided = two_sided(geometry);
    let faces = &geometry.faces;
    let shells = shells(faces).into_iter().filter(|shell| !shell.iter().any(|&f| two_sided[f as usize]));
    shells.filter(|shell| is_closed_outwards(shell, faces)).map(|shell| Solid::of(shell, faces)).collect()
}

impl Solid {
    fn of(shell: Vec<u32>, faces: &[Face]) -> Self {
        let corners = || shell.iter().flat_map(|&f| faces[f as usize].corners.iter().copied());
        let low = corners().fold(DVec3::INFINITY, DVec3::min);
        let high = corners().fold(DVec3::NEG_INFINITY, DVec3::max);
        Self { low, high, faces: shell }
    }

    /// Whether `point` lies inside, deeper than `depth` below every face. `faces` are those of the solid's part.
    pub fn holds(&self, point: DVec3, depth: f64, faces: &[Face]) -> bool {
        let in_box = (point - depth).cmpgt(self.low).all() && (point + depth).cmplt(self.high).all();
        let own = || self.faces.iter().map(|&face| &faces[face as usize].corners);
        in_box
            && own().all(|corners| distance(point, corners) > depth)
            && own().map(|corners| solid_angle(point, corners)).sum::<f64>() > 4.0 * PI * (1.0 - AROUND)
    }
}

/// Which faces have elements that look backwards.
fn two_sided(geometry: &Geometry) -> Vec<bool> {
    let mut two_sided = vec![false; geometry.faces.len()];
    for element in &geometry.elements {
        let face = element.face.index();
        two_sided[face] |= element.normal.dot(geometry.faces[face].normal) < 0.0;
    }
    two_sided
}

/// A point as a key: equal to the bit.
type Bits = [u64; 3];

fn bits(p: DVec3) -> Bits {
    (p + 0.0).to_array().map(f64::to_bits)
}

/// Faces that belong together: those that close by whole edges, and of the others those that share a corner, as the merged
/// faces of a wall with a door do.
fn shells(faces: &[Face]) -> Vec<Vec<u32>> {
    let everything: Vec<u32> = (0..faces.len() as u32).collect();
    let by_edges = together(&everything, |face| edges(&faces[face as usize]));
    let (mut shells, open): (Vec<_>, Vec<_>) =
        by_edges.into_iter().partition(|shell| is_manifold(shell, faces));
    let mut rest: Vec<u32> = open.into_iter().flatten().collect();
    rest.sort_unstable();
    let corner = |p: &DVec3| [bits(*p); 2];
    shells.extend(together(&rest, |face| faces[face as usize].corners.iter().map(corner).collect()));
    shells
}

/// The edges of a face as keys, whichever way they run.
fn edges(face: &Face) -> Vec<[Bits; 2]> {
    directed(face).map(|[a, b]| if a < b { [a, b] } else { [b, a] }).collect()
}

fn directed(face: &Face) -> impl Iterator<Item = [Bits; 2]> + '_ {
    let n = face.corners.len();
    (0..n).map(move |i| [bits(face.corners[i]), bits(face.corners[(i + 1) % n])])
}

/// Groups of `faces` that hang together by the keys that each has.
fn together(faces: &[u32], keys: impl Fn(u32) -> Vec<[Bits; 2]>) -> Vec<Vec<u32>> {
    let mut group: Vec<usize> = (0..faces.len()).collect();
    let mut first_with: HashMap<[Bits; 2], usize> = HashMap::new();
    for (number, &face) in faces.iter().enumerate() {
        for key in keys(face) {
            let other = *first_with.entry(key).or_insert(number);
            let (a, b) = (root(&mut group, number), root(&mut group, other));
            group[a.max(b)] = a.min(b);
        }
    }
    let mut members: Vec<Vec<u32>> = vec![vec![]; faces.len()];
    for (number, &face) in faces.iter().enumerate() {
        members[root(&mut group, number)].push(face);
    }
    members.retain(|group| !group.is_empty());
    members
}

fn root(group: &mut [usize], mut i: usize) -> usize {
    while group[i] != i {
        group[i] = group[group[i]];
        i = group[i];
    }
    i
}

/// Whether each edge runs as often one way as the other.
fn is_manifold(shell: &[u32], faces: &[Face]) -> bool {
    let mut balance: HashMap<[Bits; 2], i32> = HashMap::new();
    for [a, b] in shell.iter().flat_map(|&face| directed(&faces[face as usize])) {
        let (key, way) = if a < b { ([a, b], 1) } else { ([b, a], -1) };
        *balance.entry(key).or_default() += way;
    }
    balance.values().all(|&balance| balance == 0)
}

fn is_closed_outwards(shell: &[u32], faces: &[Face]) -> bool {
    let origin = faces[shell[0] as usize].corners[0];
    let (mut sum, mut area, mut volume) = (DVec3::ZERO, 0.0, 0.0);
    for &face in shell {
        for [a, b, c] in triangles(&faces[face as usize].corners) {
            let normal = (b - a).cross(c - a);
            sum += normal;
            area += normal.length();
            volume += normal.dot(a - origin);
        }
    }
    sum.length() <= CLOSED * area && volume > 0.0
}

fn triangles(corners: &[DVec3]) -> impl Iterator<Item = [DVec3; 3]> + '_ {
    corners.windows(2).skip(1).map(|edge| [corners[0], edge[0], edge[1]])
}

/// The angle under which a polygon is seen, negative from its front. Van Oosterom & Strackee 1983.
fn solid_angle(point: DVec3, corners: &[DVec3]) -> f64 {
    let of = |triangle: [DVec3; 3]| {
        let [a, b, c] = triangle.map(|corner| corner - point);
        let [la, lb, lc] = [a, b, c].map(DVec3::length);
        let below = la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb;
        2.0 * a.dot(b.cross(c)).atan2(below)
    };
    triangles(corners).map(of).sum()
}

/// The distance of a point from a convex polygon.
fn distance(point: DVec3, corners: &[DVec3]) -> f64 {
    triangles(corners).map(|triangle| triangle_distance(point, triangle)).fold(f64::INFINITY, f64::min)
}

fn triangle_distance(point: DVec3, [a, b, c]: [DVec3; 3]) -> f64 {
    let normal = (b - a).cross(c - a).normalize_or_zero();
    let within = [(a, b), (b, c), (c, a)].iter().all(|&(p, q)| normal.dot((q - p).cross(point - p)) >= 0.0);
    if within && normal != DVec3::ZERO {
        return normal.dot(point - a).abs();
    }
    let to_edge = |(p, q): (DVec3, DVec3)| {
        let along = ((point - p).dot(q - p) / (q - p).length_squared()).clamp(0.0, 1.0);
        (p + (q - p) * along - point).length()
    };
    [(a, b), (b, c), (c, a)].map(to_edge).into_iter().fold(f64::INFINITY, f64::min)
}
