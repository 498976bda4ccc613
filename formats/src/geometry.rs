//! The geometry that form factors are computed on: elements (one unknown each) and the faces that block light.

use crate::clusters::ClusterTree;
use crate::ids::{FaceId, MaterialId};
use crate::rgb::Rgb;
use glam::DVec3;
use serde::{Deserialize, Serialize};

/// Three or four corners of a planar convex polygon.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Corners {
    points: [DVec3; 4],
    count: u32,
}

impl Corners {
    /// A triangle, counter-clockwise seen from the front.
    pub fn triangle(points: [DVec3; 3]) -> Self {
        Self { points: [points[0], points[1], points[2], points[2]], count: 3 }
    }

    /// A quad, counter-clockwise seen from the front.
    pub fn quad(points: [DVec3; 4]) -> Self {
        Self { points, count: 4 }
    }

    /// The corners as twelve coordinates; a triangle's last corner is repeated.
    pub(crate) fn padded(&self) -> [f64; 12] {
        std::array::from_fn(|i| self.points[i / 3][i % 3])
    }

    /// The polygon of `count` corners from [`Corners::padded`], unless `count` is neither 3 nor 4.
    pub(crate) fn from_padded(coordinates: &[f64; 12], count: u32) -> Option<Self> {
        let [a, b, c, d] = std::array::from_fn(|i| DVec3::from_slice(&coordinates[3 * i..]));
        match count {
            3 => Some(Self::triangle([a, b, c])),
            4 => Some(Self::quad([a, b, c, d])),
            _ => None,
        }
    }

    /// The corners as a slice of 3 or 4 points.
    pub fn as_slice(&self) -> &[DVec3] {
        &self.points[..self.count as usize]
    }

    /// The same polygon seen from behind.
    pub fn flipped(&self) -> Self {
        let mut flipped = *self;
        flipped.points[..self.count as usize].reverse();
        if self.count == 3 {
            flipped.points[3] = flipped.points[2];
        }
        flipped
    }

    /// Every corner moved by `map`.
    pub fn map(&self, map: impl Fn(DVec3) -> DVec3) -> Self {
        Self { points: self.points.map(map), count: self.count }
    }

    /// Twice the area as a vector along the normal. Newell's sum, relative to the first corner so that digits are
    /// not lost far from the origin.
    pub fn double_area_vector(&self) -> DVec3 {
        double_area_vector(self.as_slice())
    }

    /// The centre of area.
    pub fn centroid(&self) -> DVec3 {
        let p = self.as_slice();
        if p.len() == 3 {
            return p[0] + ((p[1] - p[0]) + (p[2] - p[0])) / 3.0;
        }
        let (u, v, w) = (p[1] - p[0], p[2] - p[0], p[3] - p[0]);
        let normal = self.double_area_vector();
        let (left, right) = (u.cross(v).dot(normal), v.cross(w).dot(normal));
        p[0] + ((u + v) * (left / (left + right)) + (v + w) * (right / (left + right))) / 3.0
    }
}

/// Twice the area of a planar polygon as a vector along its normal (right-hand rule).
pub(crate) fn double_area_vector(points: &[DVec3]) -> DVec3 {
    let origin = points[0];
    points.windows(2).skip(1).map(|edge| (edge[0] - origin).cross(edge[1] - origin)).sum()
}

/// The smallest piece of surface with one unknown: planar, convex, one-sided. A two-sided sheet is two elements.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Element {
    /// Corners, counter-clockwise seen from the front, metres.
    pub corners: Corners,
    /// Unit normal of the front.
    pub normal: DVec3,
    /// Centre of area, the collocation point.
    pub centroid: DVec3,
    /// Area, m².
    pub area: f64,
    /// The material of its part.
    pub material: MaterialId,
    /// The face it lies in.
    pub face: FaceId,
}

impl Element {
    /// The element on `corners`, with its normal, centroid and area. The area must be above zero.
    pub fn new(corners: Corners, material: MaterialId, face: FaceId) -> Self {
        let double_area = corners.double_area_vector();
        Self {
            corners,
            normal: double_area.normalize(),
            centroid: corners.centroid(),
            area: double_area.length() / 2.0,
            material,
            face,
        }
    }
}

/// A planar convex polygon made of coplanar elements: what blocks light. It blocks from both sides.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Face {
    /// Corners in order around the polygon, at least three, metres.
    pub corners: Vec<DVec3>,
    /// Unit normal by the right-hand rule.
    pub normal: DVec3,
}

impl Face {
    /// The face on `corners`. The area must be above zero.
    pub fn new(corners: Vec<DVec3>) -> Self {
        let normal = double_area_vector(&corners).normalize();
        Self { corners, normal }
    }
}

/// Everything that form factors depend on.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Geometry {
    /// The elements; their order is the order of every per-element array.
    pub elements: Vec<Element>,
    /// The faces that the elements lie in.
    pub faces: Vec<Face>,
    /// The hierarchy of the elements.
    pub clusters: ClusterTree,
    /// The patches that are unknowns of rows by rays; none if rows are exact.
    pub patches: Option<Patches>,
}

/// Neighbouring elements as one unknown. The elements of a dense mesh are finer than its light needs to be.
#[derive(Debug, Clone, PartialEq)]
pub struct Patches {
    /// The patch of each element.
    pub of: Vec<u32>,
    /// The patches, without clusters.
    pub tree: ClusterTree,
    /// Rays a row.
    pub rays: u32,
}

impl Patches {
    /// These patches over elements. Fails with a reason if they are not numbered without gaps.
    pub fn new(of: Vec<u32>, elements: &[Element], rays: u32) -> Result<Self, String> {
        let count = of.iter().max().map_or(0, |&last| last as usize + 1);
        if of.len() != elements.len() || count > of.len() {
            return Err(format!("{} elements in {count} patches, of {}", of.len(), elements.len()));
        }
        let mut areas = vec![0.0; count];
        of.iter().zip(elements).for_each(|(&patch, element)| areas[patch as usize] += element.area);
        if let Some(empty) = areas.iter().position(|&area| area == 0.0) {
            return Err(format!("patch {empty} without elements"));
        }
        Ok(Self { of, tree: ClusterTree::flat(areas), rays })
    }

    /// The means over patches of values of elements.
    pub fn means(&self, elements: &[Element], values: &[Rgb]) -> Vec<Rgb> {
        let mut means = vec![Rgb::BLACK; self.tree.elements()];
        for ((&patch, element), &value) in self.of.iter().zip(elements).zip(values) {
            means[patch as usize] += value * (element.area / self.tree.area_of(patch as usize));
        }
        means
    }
}

impl Geometry {
    /// The unknowns and what stands for several of them: patches, or elements and clusters.
    pub fn unknowns(&self) -> &ClusterTree {
        self.patches.as_ref().map_or(&self.clusters, |patches| &patches.tree)
    }

    /// An element of an unknown, its first.
    pub fn element_of(&self, unknown: usize) -> usize {
        let first = |patches: &Patches| patches.of.iter().position(|&patch| patch as usize == unknown);
        self.patches.as_ref().and_then(first).unwrap_or(unknown)
    }

    /// The optics of the unknowns from those of the elements.
    pub fn optics_of_unknowns(&self, optics: &Optics) -> Optics {
        let Some(patches) = &self.patches else { return optics.clone() };
        let means = |values: &[Rgb]| patches.means(&self.elements, values);
        Optics { reflectance: means(&optics.reflectance), emission: means(&optics.emission) }
    }
}

/// What textures and vertex colours multiply each element's reflectance and emission by: averages over the element, one row an
/// element, linear RGB, 0..1.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Tints {
    /// On the reflectance.
    pub reflectance: Vec<Rgb>,
    /// On the emission.
    pub emission: Vec<Rgb>,
}

impl Tints {
    /// The tints of `elements` elements without textures.
    pub fn plain(elements: usize) -> Self {
        Self { reflectance: vec![Rgb::WHITE; elements], emission: vec![Rgb::WHITE; elements] }
    }
}

/// Reflectance and emission, one row an element, linear RGB. Form factors do not depend on them.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Optics {
    /// Diffuse reflectance ρ, 0..1.
    pub reflectance: Vec<Rgb>,
    /// Emission E, W/m².
    pub emission: Vec<Rgb>,
}
