//! The scene as viewers display it. Input: the placed parts. Output: the bytes of their elements, and the camera of
//! the pictures.

use crate::picture::camera::View;
use crate::picture::exposure::Exposure;
use crate::placed_parts::PlacedParts;
use equilux_bake::geometry::aabb::Aabb;
use equilux_bake::rays::RayIndex;
use equilux_formats::{Camera, Element, Rgb};
use glam::{DVec2, UVec2, uvec2};
use serde_json::json;
use std::ops::Range;
use std::sync::OnceLock;

/// Rays that sample the visible elements for the exposure; the exposure of pictures uses the rays of all pixels.
const RAYS: UVec2 = uvec2(96, 72);

/// The placed elements of a run.
#[derive(Debug)]
pub struct Model {
    /// The run that placed them.
    pub run: u32,
    elements: Vec<Element>,
    /// The range of elements of each instance.
    places: Vec<Range<usize>>,
    cameras: Vec<Camera>,
    picture_view: OnceLock<PictureView>,
}

/// The view of the pictures and the elements visible in it.
#[derive(Debug)]
struct PictureView {
    view: View,
    /// The distance of the surface in the middle of the picture, metres.
    depth: f64,
    /// The elements that rays meet, with repetition.
    elements: Vec<usize>,
}

impl Model {
    /// A copy of the placed elements.
    pub fn new(run: u32, placed: &PlacedParts, cameras: &[Camera]) -> Self {
        Self {
            run,
            elements: placed.world.elements.clone(),
            places: (0..placed.instances.len()).map(|k| placed.world.elements_of(k)).collect(),
            cameras: cameras.to_vec(),
            picture_view: OnceLock::new(),
        }
    }

    /// The elements of an instance.
    pub fn elements_of(&self, instance: usize) -> Range<usize> {
        self.places[instance].clone()
    }

    /// The exposure of the pictures.
    pub fn exposure(&self, light: &[Rgb], emission: &[Rgb]) -> Exposure {
        Exposure::choose(|| self.picture_view().elements.iter().copied(), light, emission)
    }

    /// The bytes for viewers: the length of a JSON text (u32) and that text, padded with spaces to a multiple of
    /// four; for each element four corners as three f32, with a triangle's last corner repeated, metres from the
    /// centre; for each element its instance (u32). All little-endian.
    pub fn bytes(&self) -> Vec<u8> {
        let around = Aabb::around(self.elements.iter().flat_map(|element| element.corners.as_slice()));
        let centre = around.centre();
        let PictureView { view, depth, .. } = self.picture_view();
        let head = json!({
            "run": self.run,
            "elements": self.elements.len(),
            "centre": centre.to_array(),
            "radius": around.diagonal() / 2.0,
            "eye": (view.position - centre).to_array(),
            "target": (view.position - view.back * *depth - centre).to_array(),
            "up": view.up.to_array(),
            "fov": view.vertical_fov,
            "aspect": f64::from(view.width) / f64::from(view.height),
        });
        let mut head = head.to_string().into_bytes();
        head.resize(head.len().next_multiple_of(4), b' ');
        let mut bytes = (head.len() as u32).to_le_bytes().to_vec();
        bytes.extend(head);
        for element in &self.elements {
            let corners = element.corners.as_slice();
            let four = (0..4).map(|i| corners[i.min(corners.len() - 1)] - centre);
            bytes.extend(four.flat_map(|p| p.as_vec3().to_array()).flat_map(f32::to_le_bytes));
        }
        for (instance, place) in self.places.iter().enumerate() {
            bytes.extend(place.clone().flat_map(|_| (instance as u32).to_le_bytes()));
        }
        bytes
    }

    /// Computed on first use in the server's thread, to save the run's time.
    fn picture_view(&self) -> &PictureView {
        self.picture_view.get_or_init(|| {
            let index = RayIndex::new(&self.elements);
            let view = View::of_scene(&self.cameras, &self.elements, &index);
            let depth = index.first_front(view.position, -view.back).map(|hit| hit.distance);
            let depth = depth.unwrap_or_else(|| self.middle_depth(&view));
            let pixel = DVec2::new(view.width.into(), view.height.into()) / RAYS.as_dvec2();
            let points = (0..RAYS.x * RAYS.y).map(|i| uvec2(i % RAYS.x, i / RAYS.x).as_dvec2() + 0.5);
            let meets = |point: DVec2| index.first_front(view.position, view.ray(point * pixel));
            let elements = points.filter_map(|point| Some(meets(point)?.element)).collect();
            PictureView { depth, elements, view }
        })
    }

    /// The mean distance of the elements, for pictures whose middle shows none.
    fn middle_depth(&self, view: &View) -> f64 {
        let depths = self.elements.iter().map(|e| (view.position - e.centroid).dot(view.back));
        (depths.sum::<f64>() / self.elements.len() as f64).max(1e-3)
    }
}
