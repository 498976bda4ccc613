//! The element that each point of a picture shows. Input: a [`View`] and the elements. Output: a [`Canvas`], traced
//! once and painted whenever the light changes.

use crate::picture::camera::View;
use equilux_bake::rays::RayIndex;
use equilux_formats::Rgb;
use glam::DVec2;
use image::RgbImage;
use rayon::prelude::*;

/// Positions of the rays in a pixel: a rotated grid, so that each has its own row and column.
const SAMPLES: [DVec2; 4] =
    [DVec2::new(0.375, 0.125), DVec2::new(0.875, 0.375), DVec2::new(0.125, 0.625), DVec2::new(0.625, 0.875)];

/// The elements that a view shows.
#[derive(Debug)]
pub struct Canvas {
    view: View,
    /// The elements at the samples of each pixel, row after row from the top left.
    pixels: Vec<[Option<u32>; SAMPLES.len()]>,
}

impl Canvas {
    /// Trace the fronts of the elements in `index` with `view`.
    pub fn trace(view: View, index: &RayIndex) -> Self {
        let width = view.width as usize;
        let meets = |point| Some(index.first_front(view.position, view.ray(point))?.element as u32);
        let pixel = |i: usize| SAMPLES.map(|sample| meets(corner(i, width) + sample));
        let pixels = (0..width * view.height as usize).into_par_iter().map(pixel).collect();
        Self { view, pixels }
    }

    /// The view it was traced with.
    pub fn view(&self) -> &View {
        &self.view
    }

    /// The elements of all samples that show one.
    pub fn elements(&self) -> impl Iterator<Item = usize> {
        self.pixels.iter().flatten().flatten().map(|&element| element as usize)
    }

    /// The picture in which each sample that shows an element gets the linear RGB (0..1) that `colour` returns for
    /// its image point and element, and other samples get `background`. A pixel is the mean of its samples, in sRGB.
    pub fn paint(&self, background: Rgb, colour: impl Fn(DVec2, usize) -> Rgb + Sync) -> RgbImage {
        let width = self.view.width as usize;
        let pixel = |(i, samples): (usize, &[Option<u32>; SAMPLES.len()])| {
            let mut sum = Rgb::BLACK;
            for (element, sample) in samples.iter().zip(SAMPLES) {
                let light = element.map_or(background, |e| colour(corner(i, width) + sample, e as usize));
                sum += light;
            }
            (sum / SAMPLES.len() as f64).0.map(srgb)
        };
        let bytes: Vec<[u8; 3]> = self.pixels.par_iter().enumerate().map(pixel).collect();
        RgbImage::from_raw(self.view.width, self.view.height, bytes.into_flattened())
            .expect("one colour a pixel")
    }
}

/// The top left corner of the `i`-th pixel.
fn corner(i: usize, width: usize) -> DVec2 {
    DVec2::new((i % width) as f64, (i / width) as f64)
}

/// Linear light (0..1) as a byte of sRGB. IEC 61966-2-1.
pub(crate) fn srgb(light: f64) -> u8 {
    let encoded = if light <= 0.0031308 { 12.92 * light } else { 1.055 * light.powf(1.0 / 2.4) - 0.055 };
    (encoded * 255.0).round() as u8
}
