//! The camera of a picture. Input: the file's cameras or, without any, the placed elements. Output: a [`View`], which
//! maps image points to rays and scene points to image points.
//!
//! Without a camera the scene is framed from outside. Surfaces are transparent from behind, so a closed room is seen
//! through the backs of its near walls. Of several directions, the one that shows most of the surfaces' fronts is
//! chosen.

use equilux_bake::geometry::aabb::Aabb;
use equilux_bake::geometry::polygon::Polygon;
use equilux_bake::rays::RayIndex;
use equilux_formats::{Camera, Element};
use glam::{DVec2, DVec3};
use std::f64::consts::PI;

/// Height of a picture, pixels.
const HEIGHT: u32 = 720;
/// Default width over height.
const ASPECT: f64 = 4.0 / 3.0;
/// Maximum ratio of width to height, or of height to width.
const MAX_ASPECT: f64 = 4.0;
/// Vertical field of view of a framing camera, radians.
const FRAMING_FOV: f64 = 40.0 / 180.0 * PI;
/// Share of the picture that a framed scene fills.
const FILLED_SHARE: f64 = 0.94;
/// Maximum number of elements that are sampled to rate a direction.
const MAX_SAMPLED: usize = 2000;

/// A perspective camera and the size of its picture.
#[derive(Debug, Clone, PartialEq)]
pub struct View {
    /// Position of the camera, metres.
    pub position: DVec3,
    /// Unit vector to the right of the picture.
    pub right: DVec3,
    /// Unit vector up in the picture.
    pub up: DVec3,
    /// Unit vector opposite to the viewing direction.
    pub back: DVec3,
    /// Vertical field of view, radians.
    pub vertical_fov: f64,
    /// Width of the picture, pixels.
    pub width: u32,
    /// Height of the picture, pixels.
    pub height: u32,
}

impl View {
    /// The view of the first camera, or otherwise one that frames all elements (those of `index`, at least one).
    pub fn of_scene(cameras: &[Camera], elements: &[Element], index: &RayIndex) -> Self {
        cameras.first().map_or_else(|| Self::framing(elements, index), Self::of_camera)
    }

    /// The view of `camera`, whose placement must not scale.
    pub fn of_camera(camera: &Camera) -> Self {
        let axes = camera.placement.matrix3;
        Self {
            position: camera.placement.translation,
            right: axes.x_axis,
            up: axes.y_axis,
            back: axes.z_axis,
            vertical_fov: camera.vertical_fov,
            width: width(camera.aspect.unwrap_or(ASPECT)),
            height: HEIGHT,
        }
    }

    /// The view from one point to another, with this vertical field of view, radians.
    pub fn between(from: DVec3, to: DVec3, vertical_fov: f64) -> Self {
        let back = (from - to).normalize();
        // For a vertical view, the top of the picture is north, −Z.
        let right = DVec3::Y.cross(back).try_normalize().unwrap_or(DVec3::X);
        let up = back.cross(right);
        Self { position: from, right, up, back, vertical_fov, width: width(ASPECT), height: HEIGHT }
    }

    /// The view from outside of all `elements` (those of `index`, at least one) that shows most of their fronts.
    pub fn framing(elements: &[Element], index: &RayIndex) -> Self {
        let corners = box_corners(elements);
        let rated = |back| {
            let view = Self::fitted(back, &corners);
            (view.shown(elements, index), view)
        };
        let better = |best: (f64, Self), next: (f64, Self)| if next.0 > best.0 { next } else { best };
        directions().map(rated).reduce(better).expect("there are directions").1
    }

    /// The ray through an image point, in pixels from the top left; one unit of its length is one metre of depth.
    pub fn ray(&self, point: DVec2) -> DVec3 {
        let offset = (point - self.centre()) / self.focal_length();
        self.right * offset.x - self.up * offset.y - self.back
    }

    /// The point of an element's plane at an image point, metres.
    pub fn onto(&self, point: DVec2, element: &Element) -> DVec3 {
        let ray = self.ray(point);
        let depth = element.normal.dot(element.centroid - self.position) / element.normal.dot(ray);
        self.position + ray * depth
    }

    /// The image point of a scene point as (x, y, 1) × depth: pixels from the top left, metres. Points behind the
    /// camera have negative depth, so that lines through them remain valid.
    pub fn project(&self, point: DVec3) -> DVec3 {
        let from_eye = point - self.position;
        let depth = -from_eye.dot(self.back);
        let offset = DVec2::new(from_eye.dot(self.right), -from_eye.dot(self.up)) * self.focal_length();
        (self.centre() * depth + offset).extend(depth)
    }

    fn centre(&self) -> DVec2 {
        DVec2::new(self.width.into(), self.height.into()) / 2.0
    }

    /// Distance of the image plane from the camera, pixels.
    fn focal_length(&self) -> f64 {
        f64::from(self.height) / 2.0 / (self.vertical_fov / 2.0).tan()
    }

    /// The nearest view along −`back` that contains all `points`.
    fn fitted(back: DVec3, points: &[DVec3]) -> Self {
        let right = DVec3::Y.cross(back).normalize();
        let up = back.cross(right);
        let slope = (FRAMING_FOV / 2.0).tan() * FILLED_SHARE;
        let (x, far_x) = fit(points.iter().map(|p| (p.dot(right), p.dot(back))), slope * ASPECT);
        let (y, far_y) = fit(points.iter().map(|p| (p.dot(up), p.dot(back))), slope);
        Self {
            position: right * x + up * y + back * far_x.max(far_y),
            right,
            up,
            back,
            vertical_fov: FRAMING_FOV,
            width: width(ASPECT),
            height: HEIGHT,
        }
    }

    /// Σ A √cosθ of the elements whose centroid is seen from the front at angle θ. The square root is a compromise
    /// between visible area, which favours grazing views, and projected area, which favours views onto a corner. Of
    /// many elements, a regular sample is used.
    fn shown(&self, elements: &[Element], index: &RayIndex) -> f64 {
        let seen = |&(i, element): &(usize, &Element)| {
            let sight = element.centroid - self.position;
            index.first_front(self.position, sight).is_some_and(|hit| hit.element == i)
        };
        let weight = |element: &Element| {
            let towards_eye = (self.position - element.centroid).normalize();
            element.area * element.normal.dot(towards_eye).sqrt()
        };
        let rated = elements.iter().enumerate().step_by(elements.len() / MAX_SAMPLED + 1);
        rated.filter(seen).map(|(_, element)| weight(element)).sum()
    }
}

fn width(aspect: f64) -> u32 {
    (f64::from(HEIGHT) * aspect.clamp(1.0 / MAX_ASPECT, MAX_ASPECT)).round() as u32
}

/// The position from which all `(across, towards)` points lie within `slope` on either side of the axis: the
/// coordinate across, and the distance back. The points that touch the edges of the picture bound it from both sides.
fn fit(points: impl Iterator<Item = (f64, f64)>, slope: f64) -> (f64, f64) {
    let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
    for (across, towards) in points {
        low = low.min(across - towards * slope);
        high = high.max(across + towards * slope);
    }
    ((low + high) / 2.0, (high - low) / 2.0 / slope)
}

/// The eight corners of the box around all elements.
fn box_corners(elements: &[Element]) -> Polygon {
    Aabb::around(elements.iter().flat_map(|element| element.corners.as_slice())).corners()
}

/// Unit vectors towards the cameras that are tried: around the scene, level and from above. The front of a glTF
/// scene, +Z, comes first and so wins ties.
fn directions() -> impl Iterator<Item = DVec3> {
    let around = (0..12).map(|i| f64::from(i) * PI / 6.0);
    around.flat_map(|azimuth| {
        [5.0, 30.0].map(|degrees: f64| {
            let elevation = degrees.to_radians();
            DVec3::new(azimuth.sin() * elevation.cos(), elevation.sin(), azimuth.cos() * elevation.cos())
        })
    })
}
