//! A lightmap as images: half-float EXR for engines, 8-bit PNG for viewing and for models.

use super::Lightmap;
use super::atlas::Tile;
use super::dilate::NEVER;
use crate::picture::canvas::srgb;
use crate::picture::exposure::Exposure;
use equilux_formats::{MaterialId, Rgb};
use exr::prelude::{
    Compression, Encoding, Image, Layer, LayerAttributes, LineOrder, SpecificChannels, Vec2, WritableImage,
    f16,
};
use image::RgbImage;
use image::codecs::png::PngEncoder;
use std::collections::BTreeMap;
use std::f64::consts::PI;
use std::io::{self, Cursor};

/// The units of a lightmap.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "cli", derive(clap::ValueEnum))]
pub enum Units {
    /// Irradiance, W/m², as three.js expects it
    #[default]
    Irradiance,
    // An exposure of 683 turns a watt of green light into 683 lm.
    /// Irradiance over π, the radiance of a white surface, which Bevy multiplies by its lightmap_exposure (683 for
    /// watts) to get cd/m²
    Bevy,
}

impl Units {
    /// The factor applied to irradiance.
    pub fn factor(self) -> f64 {
        match self {
            Self::Irradiance => 1.0,
            Self::Bevy => 1.0 / PI,
        }
    }

    /// Description for the list of the lightmap.
    pub fn name(self) -> &'static str {
        match self {
            Self::Irradiance => {
                "irradiance, W/m2, linear RGB (BT.709), neither divided by pi nor multiplied by reflectance"
            }
            Self::Bevy => {
                "irradiance / pi, W/(m2 sr), linear RGB (BT.709), not multiplied by reflectance; times lightmap_exposure it is cd/m2"
            }
        }
    }
}

/// Range of the largest value in which half floats keep its last digits and ten bits of a thousandth of it.
const HALF_RANGE: std::ops::RangeInclusive<f64> = 0.0625..=65504.0;

/// The factor for a lightmap's numbers, the largest of which is `most`, that makes them fit half floats: 1 where
/// possible, otherwise the power of two that brings `most` between 1024 and 2048.
pub fn half_scale(most: f64) -> f64 {
    let fits = most == 0.0 || HALF_RANGE.contains(&most);
    if fits { 1.0 } else { 2f64.powi(10 - most.log2().floor() as i32) }
}

/// One image of the lightmap: for each texel `value` of its tile and its index in the tile, otherwise `empty`.
/// Rectangles of an author's layout may overlap: each texel belongs to the nearest chart.
fn image<T: Copy>(lightmap: &Lightmap, image: usize, empty: T, value: impl Fn(usize, usize) -> T) -> Vec<T> {
    let [width, height] = lightmap.atlas.images[image].map(|side| side as usize);
    let (mut texels, mut nearest) = (vec![empty; width * height], vec![NEVER; width * height]);
    let here = |(_, tile): &(usize, &Tile)| tile.spot.image == image;
    for (number, tile) in lightmap.tiles.iter().enumerate().filter(here) {
        let [left, top] = tile.spot.at.map(|at| at as usize);
        let columns = tile.size[0] as usize;
        for (index, &distance) in lightmap.distances[number].iter().enumerate() {
            let texel = (top + index / columns) * width + left + index % columns;
            if distance < nearest[texel] {
                (texels[texel], nearest[texel]) = (value(number, index), distance);
            }
        }
    }
    texels
}

/// The EXR file of an image: irradiance times `factor`, as half floats, compressed without loss. Fails if it cannot
/// be encoded.
pub fn exr(lightmap: &Lightmap, number: usize, factor: f64) -> io::Result<Vec<u8>> {
    half_floats(lightmap, number, |tile, texel| (lightmap.irradiance[tile][texel] * factor).0)
}

/// The EXR file of an image's directions, x, y and z as red, green and blue.
pub fn directions_exr(
    lightmap: &Lightmap,
    number: usize,
    directions: &[Vec<[f64; 3]>],
) -> io::Result<Vec<u8>> {
    half_floats(lightmap, number, |tile, texel| directions[tile][texel])
}

fn half_floats(
    lightmap: &Lightmap,
    number: usize,
    value: impl Fn(usize, usize) -> [f64; 3],
) -> io::Result<Vec<u8>> {
    let texels = image(lightmap, number, [f16::ZERO; 3], |tile, texel| value(tile, texel).map(f16::from_f64));
    let [width, height] = lightmap.atlas.images[number].map(|side| side as usize);
    let channels = SpecificChannels::rgb(|Vec2(x, y)| {
        let [r, g, b] = texels[y * width + x];
        (r, g, b)
    });
    let encoding = Encoding {
        compression: Compression::ZIP16,
        line_order: LineOrder::Increasing,
        ..Encoding::SMALL_LOSSLESS
    };
    let layer = Layer::new((width, height), LayerAttributes::default(), encoding, channels);
    let mut file = Cursor::new(Vec::new());
    Image::from_layer(layer).write().to_buffered(&mut file).map_err(io::Error::other)?;
    Ok(file.into_inner())
}

/// The PNG file of an image: irradiance, displayed as a white surface in the pictures.
pub fn png(lightmap: &Lightmap, number: usize, exposure: Exposure) -> io::Result<Vec<u8>> {
    encode(lightmap, number, |tile, texel| exposure.shown(lightmap.irradiance[tile][texel]))
}

/// The PNG file of an image: radiosity, displayed as in the pictures.
pub fn shown_png(lightmap: &Lightmap, number: usize, exposure: Exposure) -> io::Result<Vec<u8>> {
    encode(lightmap, number, |tile, texel| exposure.shown(lightmap.radiosity(tile, texel)))
}

/// The brightest radiosity of each material of each instance, W/m².
pub type Peaks = BTreeMap<(usize, MaterialId), f64>;

/// The peaks of all materials: see [`Peaks`].
pub fn peaks(lightmap: &Lightmap) -> Peaks {
    let mut peaks = Peaks::new();
    for (number, tile) in lightmap.tiles.iter().enumerate() {
        let texels =
            (0..lightmap.irradiance[number].len()).flat_map(|texel| lightmap.radiosity(number, texel));
        let peak = peaks.entry((tile.instance, lightmap.material_of(tile).0)).or_insert(0.0);
        *peak = texels.fold(*peak, f64::max);
    }
    peaks
}

/// The PNG file of an image: radiosity as a share of its peak, so that eight bits preserve dim walls next to bright
/// lamps.
pub fn relative_png(lightmap: &Lightmap, number: usize, peaks: &Peaks) -> io::Result<Vec<u8>> {
    let of_tile: Vec<f64> =
        lightmap.tiles.iter().map(|tile| peaks[&(tile.instance, lightmap.material_of(tile).0)]).collect();
    let share = |b: f64, peak: f64| if peak > 0.0 { b / peak } else { 0.0 };
    encode(lightmap, number, |tile, texel| lightmap.radiosity(tile, texel).map(|b| share(b, of_tile[tile])))
}

/// The PNG file of an image of linear RGB, 0..1, in sRGB.
fn encode(lightmap: &Lightmap, number: usize, colour: impl Fn(usize, usize) -> Rgb) -> io::Result<Vec<u8>> {
    let texels = image(lightmap, number, [0; 3], |tile, texel| colour(tile, texel).0.map(srgb));
    let [width, height] = lightmap.atlas.images[number];
    let picture = RgbImage::from_raw(width, height, texels.into_flattened()).expect("one colour a texel");
    let mut file = Vec::new();
    picture.write_with_encoder(PngEncoder::new(&mut file)).map_err(io::Error::other)?;
    Ok(file)
}
