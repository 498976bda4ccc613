//! Faces for tests: a soup, a box whose sides are cut at random, and a globe; and the places on them that rays are aimed at.

use equilux_formats::{ClusterTree, Corners, Element, Face, FaceId, Geometry, MaterialId};
use glam::{DAffine3, DQuat, DVec3};
use proptest::prelude::*;
use proptest::sample::Index;
use std::f64::consts::{PI, TAU};

/// A point of the cube from -1 to 1.
pub fn point() -> impl Strategy<Value = DVec3> {
    prop::array::uniform3(-1.0..1.0).prop_map(DVec3::from_array)
}

/// A rotation.
pub fn rotation() -> impl Strategy<Value = DQuat> {
    (point(), 0.0..TAU).prop_map(|(axis, angle)| DQuat::from_axis_angle(axis.normalize_or(DVec3::X), angle))
}

/// A similarity: turned, scaled by up to four either way, moved, and maybe mirrored.
pub fn similarity() -> impl Strategy<Value = DAffine3> {
    (rotation(), -2.0..2.0_f64, point(), any::<bool>()).prop_map(|(turn, scale, to, is_mirrored)| {
        let mirror = if is_mirrored { -1.0 } else { 1.0 };
        let scale = DVec3::new(mirror, 1.0, 1.0) * scale.exp2();
        DAffine3::from_scale_rotation_translation(scale, turn, to * 3.0)
    })
}

/// Triangles, parallelograms and other convex quads of sizes from a thousandth to one, in the cube from -2 to 2.
pub fn soup() -> impl Strategy<Value = Vec<Face>> {
    let face = (point(), point(), point(), -3.0..0.0_f64, 0..3).prop_filter_map(
        "has an area",
        |(corner, u, v, magnitude, kind)| {
            let (u, v) = (u * 10f64.powf(magnitude), v * 10f64.powf(magnitude));
            let mut corners = vec![corner, corner + u, corner + u + v, corner + v];
            match kind {
                0 => corners.truncate(3),
                1 => corners[2] = corner + u * 0.7 + v * 0.9,
                _ => {}
            }
            (u.cross(v).length() > 0.05 * u.length() * v.length()).then(|| Face::new(corners))
        },
    );
    prop::collection::vec(face, 1..60)
}

/// The faces of a box seen from inside, with edges of 1 to 8, around the origin. Sides are cut into smaller faces of all sizes,
/// so that corners lie on others' edges. All coordinates of an edge but one are equal to the bit: the box is closed.
pub fn room() -> impl Strategy<Value = Vec<Face>> {
    let cut = (any::<Index>(), any::<bool>(), 0.05..0.95_f64);
    (prop::array::uniform3(0.5..4.0), prop::collection::vec(cut, 0..60)).prop_map(|(half, cuts)| {
        let half = DVec3::from_array(half);
        let mut sides: Vec<Rectangle> = (0..6)
            .map(|side| Rectangle { axis: side / 2, is_high: side % 2 == 1, low: [-1.0; 2], high: [1.0; 2] })
            .collect();
        for (side, across, share) in cuts {
            let side = side.index(sides.len());
            let second = sides[side].cut(usize::from(across), share);
            sides.push(second);
        }
        sides.iter().map(|side| Face::new(side.corners().map(|corner| corner * half).to_vec())).collect()
    })
}

/// A rectangle on a side of the cube from -1 to 1.
#[derive(Clone)]
struct Rectangle {
    axis: usize,
    is_high: bool,
    low: [f64; 2],
    high: [f64; 2],
}

impl Rectangle {
    /// Keeps the lower piece and returns the other.
    fn cut(&mut self, across: usize, share: f64) -> Self {
        let mut second = self.clone();
        let place = self.low[across] + (self.high[across] - self.low[across]) * share;
        (self.high[across], second.low[across]) = (place, place);
        second
    }

    /// Its corners, counter-clockwise seen from inside the cube.
    fn corners(&self) -> [DVec3; 4] {
        let ([x0, y0], [x1, y1]) = (self.low, self.high);
        let mut corners = [[x0, y0], [x1, y0], [x1, y1], [x0, y1]].map(|[x, y]| {
            let mut corner = DVec3::ZERO;
            corner[self.axis] = if self.is_high { 1.0 } else { -1.0 };
            corner[(self.axis + 1) % 3] = x;
            corner[(self.axis + 2) % 3] = y;
            corner
        });
        if self.is_high {
            corners.reverse();
        }
        corners
    }
}

/// A turned globe of radius 1 seen from inside, its neighbours sharing corners to the bit: quads between meridians and
/// parallels, cut in two or not, and triangles at the poles.
pub fn globe() -> impl Strategy<Value = Vec<Face>> {
    (rotation(), 3..20_usize, 6..30_usize, any::<bool>()).prop_map(|(turn, bands, sectors, is_cut)| {
        let corner = |band: usize, sector: usize| {
            if band == 0 || band == bands {
                return turn * if band == 0 { DVec3::Z } else { -DVec3::Z };
            }
            let (theta, phi) =
                (PI * band as f64 / bands as f64, TAU * (sector % sectors) as f64 / sectors as f64);
            turn * DVec3::new(theta.sin() * phi.cos(), theta.sin() * phi.sin(), theta.cos())
        };
        let mut faces = vec![];
        for (band, sector) in (0..bands).flat_map(|band| (0..sectors).map(move |sector| (band, sector))) {
            let [a, b] = [corner(band, sector), corner(band, sector + 1)];
            let [c, d] = [corner(band + 1, sector + 1), corner(band + 1, sector)];
            match band {
                0 => faces.push(vec![a, c, d]),
                _ if band == bands - 1 => faces.push(vec![a, b, c]),
                _ if is_cut => faces.extend([vec![a, b, c], vec![a, c, d]]),
                _ => faces.push(vec![a, b, c, d]),
            }
        }
        faces.into_iter().map(Face::new).collect()
    })
}

/// Where on a face a ray is aimed.
#[derive(Debug, Clone)]
pub struct Aim {
    face: Index,
    corner: Index,
    kind: u8,
    share: f64,
}

/// Corners, edges and insides of faces, equally often.
pub fn aim() -> impl Strategy<Value = Aim> {
    (any::<Index>(), any::<Index>(), 0..3_u8, 0.0..1.0_f64).prop_map(|(face, corner, kind, share)| Aim {
        face,
        corner,
        kind,
        share,
    })
}

impl Aim {
    /// The place among these faces.
    pub fn at(&self, faces: &[Face]) -> DVec3 {
        let corners = &faces[self.face.index(faces.len())].corners;
        let first = self.corner.index(corners.len());
        let (a, b) = (corners[first], corners[(first + 1) % corners.len()]);
        let centre = corners.iter().sum::<DVec3>() / corners.len() as f64;
        match self.kind {
            0 => a,
            1 => a.lerp(b, self.share),
            _ => a.lerp(b, self.share).lerp(centre, self.share),
        }
    }
}

/// A part with these faces, each its own element.
pub fn part(faces: &[Face]) -> Geometry {
    let element = |(number, face): (usize, &Face)| {
        let corners = match face.corners[..] {
            [a, b, c] => Corners::triangle([a, b, c]),
            [a, b, c, d] => Corners::quad([a, b, c, d]),
            _ => unreachable!("faces of tests have three or four corners"),
        };
        Element::new(corners, MaterialId(0), FaceId(number as u32))
    };
    Geometry {
        elements: faces.iter().enumerate().map(element).collect(),
        faces: faces.to_vec(),
        clusters: ClusterTree::default(),
        patches: None,
    }
}
