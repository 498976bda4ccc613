//! Pictures of the light and of the elements. Input: a [`Canvas`] and per-element light. Output: images and PNG
//! files.

pub mod camera;
pub mod canvas;
pub mod difference;
pub mod exposure;
mod interpolation;
pub mod shot;
mod smooth;

use crate::output_file;
use crate::picture::canvas::Canvas;
use crate::picture::exposure::Exposure;
use equilux_formats::{Element, Result, Rgb};
use glam::{DVec2, DVec3};
use image::RgbImage;
use image::codecs::png::PngEncoder;
use image::imageops::{self, FilterType};
use std::io;
use std::path::Path;

/// Background, linear RGB: a dark grey that is unlikely as the colour of a surface.
pub const BACKGROUND: Rgb = Rgb::splat(0.02);
/// Colours of the wireframe: background, surfaces and lines, linear RGB.
const PAPER: Rgb = Rgb::WHITE;
const SURFACE: Rgb = Rgb::splat(0.85);
const LINE: Rgb = Rgb::splat(0.01);
/// Gap between pictures side by side, pixels.
const GAP: u32 = 6;
/// Half the width of a line between two elements, pixels.
const HALF_LINE: f64 = 0.7;

/// The lit scene, each element in one colour. `radiosity`: W/m², one row an element.
pub fn shade(canvas: &Canvas, radiosity: &[Rgb], exposure: Exposure) -> RgbImage {
    let colours: Vec<Rgb> = radiosity.iter().map(|&b| exposure.shown(b)).collect();
    canvas.paint(BACKGROUND, |_, element| colours[element])
}

/// The visible edges of the elements as dark lines on a light background. `elements`: those with which the canvas was
/// traced.
pub fn wireframe(canvas: &Canvas, elements: &[Element]) -> RgbImage {
    canvas.paint(PAPER, |point, element| {
        let corners = elements[element].corners.as_slice();
        if edge_distance(canvas, corners, point) < HALF_LINE { LINE } else { SURFACE }
    })
}

/// Pictures of one size side by side, at half their size.
pub fn strip(pictures: &[RgbImage]) -> RgbImage {
    let small: Vec<RgbImage> = pictures
        .iter()
        .map(|picture| {
            let [width, height] = [picture.width(), picture.height()].map(|side| (side / 2).max(1));
            imageops::resize(picture, width, height, FilterType::Triangle)
        })
        .collect();
    let (width, height) = small.first().map_or((1, 1), RgbImage::dimensions);
    let mut strip =
        RgbImage::from_pixel((width + GAP) * small.len() as u32 - GAP, height, image::Rgb([255; 3]));
    for (place, picture) in small.iter().enumerate() {
        imageops::replace(&mut strip, picture, i64::from(width + GAP) * place as i64, 0);
    }
    strip
}

/// Distance from an image point inside a convex polygon's picture to the nearest of its edges, pixels.
fn edge_distance(canvas: &Canvas, corners: &[DVec3], point: DVec2) -> f64 {
    let project = |i: usize| canvas.view().project(corners[i % corners.len()]);
    let to_edge = |i| {
        // In homogeneous coordinates the line through two points is their cross product, even behind the camera.
        let line = project(i).cross(project(i + 1));
        (line.dot(point.extend(1.0)) / line.truncate().length()).abs()
    };
    (0..corners.len()).map(to_edge).fold(f64::INFINITY, f64::min)
}

/// Write `image` to `path` as PNG. Fails if it cannot be written.
pub fn write_png(path: &Path, image: &RgbImage) -> Result<()> {
    output_file::write(path, |out| image.write_with_encoder(PngEncoder::new(out)).map_err(io::Error::other))
}
