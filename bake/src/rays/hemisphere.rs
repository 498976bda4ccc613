//! The rays of an unknown: origins over its area, directions by the cosine around its normal.
//!
//! Everything is in the coordinates of its part, so rays move with the part, and is chosen by where the unknown lies in it: an
//! element has the same rays whatever its number, and so also as an element of one cell of a divided scene.

use super::samples::{Sample, Samples};
use super::sobol::hash;
use super::wide_tree::Ray;
use crate::geometry::aabb::Aabb;
use equilux_formats::{Element, Face};
use glam::DVec3;
use std::f64::consts::TAU;

/// How far from the edges of an element its rays start, as a share of it: a ray from an edge may start inside a neighbour.
const INSET: f64 = 1e-4;

/// How far in front of an element and of its face's plane its rays start, in its size: far less than [`INSET`], so that a ray
/// that starts beside a neighbour starts in front of it too; far more than f64 rounds.
const IN_FRONT: f64 = 1e-6;

/// The polygons of an unknown, as triangles and parallelograms to start from.
#[derive(Debug)]
pub struct Emitters {
    pieces: Vec<Piece>,
    /// Up to which share of the area each piece goes.
    until: Vec<f64>,
    bounds: Aabb,
    number: u32,
}

/// A triangle or parallelogram with its frame.
#[derive(Debug, Clone, Copy)]
struct Piece {
    corner: DVec3,
    edges: [DVec3; 2],
    is_parallelogram: bool,
    /// Tangents and normal for light.
    frame: [DVec3; 3],
    /// From it to where rays start.
    lift: DVec3,
}

/// The smooth surface for which a flat piece stands, at one place.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SurfacePoint {
    /// Its unit normal.
    pub normal: DVec3,
    /// From the piece to it, metres.
    pub lift: DVec3,
}

impl Emitters {
    /// The area of these elements. Their faces may be as far off their planes as their own corners.
    pub fn new<'a>(elements: impl IntoIterator<Item = &'a Element>) -> Self {
        Self::beyond(elements.into_iter().map(|element| (element, element.corners.as_slice())))
    }

    /// The area of these elements, each with the smooth surface for which it stands. With normals of their own and no lifts, the
    /// same as [`Emitters::new`].
    pub fn curved(elements: &[(Element, SurfacePoint)]) -> Self {
        let pieces = elements.iter().flat_map(|(element, SurfacePoint { normal, lift })| {
            let raised = pieces_beyond(element, element.corners.as_slice());
            raised.map(move |piece| match *normal == element.normal {
                true => piece,
                false => Piece { frame: frame(*normal), lift: piece.lift + *lift, ..piece },
            })
        });
        let numbers = elements.iter().map(|(element, _)| number_at(element.centroid));
        let number = numbers.fold(0u32, u32::wrapping_add);
        Self::of(pieces.collect(), number)
    }

    /// The area of these elements, each on a face, whose plane goes through its first corner.
    pub fn on<'a>(elements: impl IntoIterator<Item = (&'a Element, &'a Face)>) -> Self {
        Self::beyond(elements.into_iter().map(|(element, face)| (element, &face.corners[..1])))
    }

    /// The area of these elements. Rays of each start in front of the planes through some points that are parallel to it.
    /// Corners that are stored in f32 lie off the plane of their face; for small elements, by more than [`IN_FRONT`] of their
    /// size. Rays that start behind that plane would end on their own face.
    fn beyond<'a>(elements: impl IntoIterator<Item = (&'a Element, &'a [DVec3])>) -> Self {
        let mut number = 0u32;
        let numbered = elements.into_iter().inspect(|(element, _)| {
            number = number.wrapping_add(number_at(element.centroid));
        });
        let pieces = numbered.flat_map(|(element, points)| pieces_beyond(element, points)).collect();
        Self::of(pieces, number)
    }

    fn of(pieces: Vec<Piece>, number: u32) -> Self {
        let mut sum = 0.0;
        let areas = pieces.iter().map(Piece::area);
        let mut until: Vec<f64> = areas
            .map(|area| {
                sum += area;
                sum
            })
            .collect();
        until.iter_mut().for_each(|share| *share /= sum);
        let corners = pieces.iter().flat_map(Piece::corners);
        Self { bounds: Aabb::around(corners), pieces, until, number }
    }

    /// Whether it is one parallelogram.
    pub fn is_parallelogram(&self) -> bool {
        matches!(self.pieces.as_slice(), [piece] if piece.is_parallelogram)
    }

    /// The box around it.
    pub fn bounds(&self) -> Aabb {
        self.bounds
    }

    /// A number that follows from where its elements lie, in any order, and chooses its rays.
    pub fn number(&self) -> u32 {
        self.number
    }

    /// The outermost places on each of its pieces, between which all others lie.
    pub fn extremes(&self) -> impl Iterator<Item = DVec3> + '_ {
        let corners = [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)];
        self.pieces.iter().flat_map(move |piece| corners.map(|(u, v)| piece.place(u, v)))
    }

    /// The normal of each of its pieces.
    pub fn normals(&self) -> impl Iterator<Item = DVec3> + '_ {
        self.pieces.iter().map(|piece| piece.frame[2])
    }

    /// A place on it, set off its plane, and the normal there, from two numbers in 0..1.
    #[inline(always)]
    pub fn place(&self, mut u: f64, v: f64) -> (DVec3, DVec3) {
        let piece = self.piece(&mut u);
        (piece.place(u, v), piece.frame[2])
    }

    /// Writes the rays that `number` chooses.
    #[inline(always)]
    pub fn rays(&self, samples: &Samples, number: u32, rays: &mut Vec<Ray>) {
        let seed = hash(number);
        let (sine, cosine) = turn(seed);
        let moved = hash(seed ^ 0x51ed);
        let shift = [moved & 0xffff, moved >> 16].map(|bits| f64::from(bits) / 65536.0);
        rays.clear();
        rays.extend(samples.set(seed).iter().map(|sample| {
            let Sample { direction: [x, y, z], origin } = *sample;
            let [mut u, v] = [0, 1].map(|k| {
                let moved = origin[k] + shift[k];
                if moved >= 1.0 { moved - 1.0 } else { moved }
            });
            let piece = self.piece(&mut u);
            let [tangent, bitangent, normal] = piece.frame;
            let (x, y) = (x * cosine - y * sine, x * sine + y * cosine);
            Ray { origin: piece.place(u, v), direction: tangent * x + bitangent * y + normal * z }
        }));
    }

    /// The piece at the share `u` of the area, and in `u` the share of that piece.
    #[inline(always)]
    fn piece(&self, u: &mut f64) -> &Piece {
        if let [piece] = self.pieces.as_slice() {
            return piece;
        }
        let number = self.until.partition_point(|&share| share <= *u).min(self.pieces.len() - 1);
        let from = if number == 0 { 0.0 } else { self.until[number - 1] };
        *u = ((*u - from) / (self.until[number] - from)).clamp(0.0, 1.0);
        &self.pieces[number]
    }
}

/// The rays of a point on a surface, the centroid of this element; chosen by where it lies.
pub fn rays_from(point: &Element, samples: &Samples) -> Vec<Ray> {
    let seed = number_at(point.centroid);
    let [tangent, bitangent, normal] = frame(point.normal);
    let (sine, cosine) = turn(seed);
    let size = point.centroid.length().max(1.0);
    let origin = point.centroid + normal * (IN_FRONT * size);
    let ray = |sample: &Sample| {
        let [x, y, z] = sample.direction;
        let (x, y) = (x * cosine - y * sine, x * sine + y * cosine);
        Ray { origin, direction: tangent * x + bitangent * y + normal * z }
    };
    samples.set(seed).iter().map(ray).collect()
}

/// A number that follows from a place, to the bit.
fn number_at(place: DVec3) -> u32 {
    place.to_array().iter().fold(0, |number, x| {
        let bits = x.to_bits();
        hash(number ^ bits as u32 ^ hash((bits >> 32) as u32))
    })
}

/// The sine and cosine of a turn of the azimuth.
#[inline(always)]
fn turn(seed: u32) -> (f64, f64) {
    (f64::from(hash(hash(seed ^ 0x51ed))) / 4_294_967_296.0 * TAU).sin_cos()
}

impl Piece {
    fn new(corner: DVec3, edges: [DVec3; 2], is_parallelogram: bool, normal: DVec3) -> Self {
        let lift = normal * (IN_FRONT * (edges[0].length() + edges[1].length()));
        Self { corner, edges, is_parallelogram, frame: frame(normal), lift }
    }

    fn corners(&self) -> [DVec3; 4] {
        let (p, [u, v]) = (self.corner, self.edges);
        [p, p + u, p + v, if self.is_parallelogram { p + u + v } else { p }]
    }

    fn area(&self) -> f64 {
        let [u, v] = self.edges;
        u.cross(v).length() * if self.is_parallelogram { 1.0 } else { 0.5 }
    }

    /// A place on it, set in from its edges and set off its plane.
    #[inline(always)]
    fn place(&self, u: f64, v: f64) -> DVec3 {
        let [a, b] = self.edges;
        let inset = |x: f64| INSET + x * (1.0 - 2.0 * INSET);
        let (u, v) = if self.is_parallelogram {
            (inset(u), inset(v))
        } else {
            // Uniform over the triangle; then drawn towards its centre.
            let root = u.sqrt();
            let third = |x: f64| INSET + x * (1.0 - 3.0 * INSET);
            (third(1.0 - root), third(root * v))
        };
        self.corner + a * u + b * v + self.lift
    }
}

/// The pieces of an element, with rays that start in front of the planes through these points that are parallel to it.
fn pieces_beyond(element: &Element, points: &[DVec3]) -> impl Iterator<Item = Piece> + use<> {
    let height = |p: &DVec3| element.normal.dot(*p - element.corners.as_slice()[0]);
    let top = points.iter().map(height).fold(f64::NEG_INFINITY, f64::max);
    let bottom = element.corners.as_slice().iter().map(height).fold(f64::INFINITY, f64::min);
    let raised = element.normal * (top - bottom).max(0.0);
    pieces(element).into_iter().map(move |piece| Piece { lift: piece.lift + raised, ..piece })
}

/// The pieces of an element: itself, or the two triangles of a quad that is no parallelogram.
fn pieces(element: &Element) -> Vec<Piece> {
    let normal = element.normal;
    match *element.corners.as_slice() {
        [a, b, c, d] if ((a + c) - (b + d)).length() <= 1e-9 * (c - a).length() => {
            vec![Piece::new(a, [b - a, d - a], true, normal)]
        }
        [a, b, c, d] => {
            vec![Piece::new(a, [b - a, c - a], false, normal), Piece::new(a, [c - a, d - a], false, normal)]
        }
        [a, b, c] => vec![Piece::new(a, [b - a, c - a], false, normal)],
        _ => unreachable!("elements have three or four corners"),
    }
}

/// Two tangents and the normal (Duff et al. 2017, "Building an orthonormal basis, revisited").
pub(super) fn frame(n: DVec3) -> [DVec3; 3] {
    let sign = 1f64.copysign(n.z);
    let a = -1.0 / (sign + n.z);
    let b = n.x * n.y * a;
    [
        DVec3::new(1.0 + sign * n.x * n.x * a, sign * b, -sign * n.x),
        DVec3::new(b, sign + n.y * n.y * a, -n.y),
        n,
    ]
}

#[cfg(test)]
mod tests {
    use super::super::shapes::rotation;
    use super::*;
    use equilux_formats::{Corners, FaceId, MaterialId};
    use proptest::prelude::*;
    use std::sync::LazyLock;

    /// Rays of a test.
    const RAYS: usize = 4096;

    static SAMPLES: LazyLock<Samples> = LazyLock::new(|| Samples::new(RAYS as u32));

    /// How far the mean of RAYS independent numbers with this standard deviation may be from its expectation: five standard
    /// errors, one in 1.7 million. Sobol points are nearer.
    fn spread(deviation: f64) -> f64 {
        5.0 * deviation / (RAYS as f64).sqrt()
    }

    /// Elements in the plane z = 0 of unit size: a triangle, a parallelogram, another quad, and all of them beside each other.
    fn areas() -> Vec<Vec<Element>> {
        let at = |x: f64, y: f64| DVec3::new(x, y, 0.0);
        let element = |corners| Element::new(corners, MaterialId(0), FaceId(0));
        let triangle = element(Corners::triangle([at(0.0, 0.0), at(1.0, 0.2), at(0.3, 0.7)]));
        let parallelogram = element(Corners::quad([at(1.0, 0.0), at(1.9, 0.1), at(2.0, 0.7), at(1.1, 0.6)]));
        let quad = element(Corners::quad([at(2.0, 0.0), at(2.5, 0.2), at(2.6, 0.4), at(2.1, 0.9)]));
        vec![vec![triangle], vec![parallelogram], vec![quad], vec![triangle, parallelogram, quad]]
    }

    fn contains(element: &Element, place: DVec3) -> bool {
        let corners = element.corners.as_slice();
        (0..corners.len()).all(|i| {
            let (a, b) = (corners[i], corners[(i + 1) % corners.len()]);
            element.normal.dot((b - a).cross(place - a)) > 0.0
        })
    }

    fn turned(elements: &[Element], turn: glam::DQuat) -> Vec<Element> {
        let turned = |element: &Element| {
            let corners = match *element.corners.as_slice() {
                [a, b, c] => Corners::triangle([a, b, c].map(|corner| turn * corner)),
                [a, b, c, d] => Corners::quad([a, b, c, d].map(|corner| turn * corner)),
                _ => unreachable!("elements have three or four corners"),
            };
            Element::new(corners, element.material, element.face)
        };
        elements.iter().map(turned).collect()
    }

    fn mean(numbers: impl Iterator<Item = f64>) -> f64 {
        numbers.sum::<f64>() / RAYS as f64
    }

    proptest! {
        #[test]
        fn origins_are_uniform_and_inside(turn in rotation(), number in 0u32.., area in 0..4_usize) {
            let elements = turned(&areas()[area], turn);
            let mut rays = vec![];
            Emitters::new(&elements).rays(&SAMPLES, number, &mut rays);
            let whole: f64 = elements.iter().map(|element| element.area).sum();
            for element in &elements {
                let own: Vec<&Ray> = rays.iter().filter(|ray| contains(element, ray.origin)).collect();
                let (count, share) = (own.len() as f64 / RAYS as f64, element.area / whole);
                prop_assert!((count - share).abs() <= spread((share * (1.0 - share)).sqrt()), "{count} {share}");
                let centre = own.iter().map(|ray| ray.origin).sum::<DVec3>() / own.len() as f64;
                // No element is wider than 1.2, nor deviates more than a third of that; the inset keeps the middle.
                let off = spread(0.4) / share.sqrt() + 3.0 * INSET;
                prop_assert!((centre - element.centroid).length() <= off, "{centre} {}", element.centroid);
            }
            let inside = rays.iter().filter(|ray| elements.iter().any(|e| contains(e, ray.origin))).count();
            prop_assert_eq!(inside, RAYS);
        }

        /// A uniform triangle 0, u, v has mean squares of a and b in a u + b v of 1/6 and a mean product of 1/12; a parallelogram
        /// 1/3 and 1/4.
        #[test]
        fn origins_have_the_second_moments_of_their_shape(number in 0u32.., area in 0..2_usize) {
            let element = &areas()[area][0];
            let corners = element.corners.as_slice();
            let (o, u, v) = (corners[0], corners[1] - corners[0], corners[corners.len() - 1] - corners[0]);
            let mut rays = vec![];
            Emitters::new([element]).rays(&SAMPLES, number, &mut rays);
            let double = element.normal.dot(u.cross(v));
            let coordinates = rays.iter().map(|ray| {
                let p = ray.origin - o;
                [element.normal.dot(p.cross(v)) / double, element.normal.dot(u.cross(p)) / double]
            });
            let (square, product) = if area == 0 { (1.0 / 6.0, 1.0 / 12.0) } else { (1.0 / 3.0, 1.0 / 4.0) };
            // Numbers in [0, 1] deviate by at most a half; here by less than a third.
            let off = spread(1.0 / 3.0) + 3.0 * INSET;
            for (k, l, expected) in [(0, 0, square), (1, 1, square), (0, 1, product)] {
                let found = mean(coordinates.clone().map(|c| c[k] * c[l]));
                prop_assert!((found - expected).abs() <= off, "{found} {expected}");
            }
        }

        /// The cosine z of a cosine-distributed direction has the density 2 z: mean 2/3, mean square 1/2, so its standard
        /// deviation is (1/18)^½, that of its square 12^-½; x and y have mean 0 and mean square 1/4.
        #[test]
        fn directions_are_distributed_by_the_cosine(turn in rotation(), number in 0u32.., area in 0..3_usize) {
            let element = &turned(&areas()[area], turn)[0];
            let mut rays = vec![];
            Emitters::new([element]).rays(&SAMPLES, number, &mut rays);
            let [x, y, z] = frame(element.normal);
            let along = |axis: DVec3| rays.iter().map(move |ray| ray.direction.dot(axis));
            // Products of a few numbers near 1.
            prop_assert!(rays.iter().all(|ray| (ray.direction.length() - 1.0).abs() < 8.0 * f64::EPSILON));
            prop_assert!(along(z).all(|cosine| cosine >= 0.0));
            prop_assert!((mean(along(z)) - 2.0 / 3.0).abs() <= spread((1.0f64 / 18.0).sqrt()));
            prop_assert!((mean(along(z).map(|c| c * c)) - 0.5).abs() <= spread((1.0f64 / 12.0).sqrt()));
            for axis in [x, y] {
                prop_assert!(mean(along(axis)).abs() <= spread(0.5));
                prop_assert!((mean(along(axis).map(|c| c * c)) - 0.25).abs() <= spread(0.25));
            }
        }

        /// Quads of a few centimetres, as glTF stores them at a few metres from the origin: up to 1e-7 m off any plane.
        #[test]
        fn rays_start_in_front_of_their_face(
            (at, turn, size) in (crate::rays::shapes::point(), rotation(), 0.002..0.1_f64),
            number in 0u32..,
        ) {
            let corner = |x: f64, y: f64| (at * 4.0 + turn * DVec3::new(x, y, 0.0) * size).as_vec3().as_dvec3();
            let corners = [corner(0.0, 0.0), corner(1.0, 0.0), corner(1.0, 1.0), corner(0.0, 1.0)];
            let face = Face::new(corners.to_vec());
            let [a, b, c, d] = corners;
            for side in [[a, b, c, d], [d, c, b, a]] {
                let element = Element::new(Corners::quad(side), MaterialId(0), FaceId(0));
                let mut rays = vec![];
                Emitters::on([(&element, &face)]).rays(&SAMPLES, number, &mut rays);
                let height = |ray: &Ray| (ray.origin - face.corners[0]).dot(element.normal);
                let lowest = rays.iter().map(height).fold(f64::INFINITY, f64::min);
                prop_assert!(lowest > 0.0, "{lowest} m in front of the face");
            }
        }
    }
}
