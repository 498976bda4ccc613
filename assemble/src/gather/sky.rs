//! The sky as far polygons: the six sides of a cube around the scene, each divided into cells of equal angular width
//! seen from its centre.
//!
//! The radiance of the sky does not change visibility: the cells are fixed, and each sends the mean radiance of the
//! sky in it.

use equilux_bake::elements::clusters::hierarchy;
use equilux_bake::oven::placed_keys::SKY_CELLS;
use equilux_formats::{Corners, Element, Error, Face, FaceId, Geometry, MaterialId, Result, Rgb};
use glam::DVec3;
use image::codecs::hdr::HdrDecoder;
use image::{DynamicImage, ImageFormat, ImageReader, ImageResult};
use std::f64::consts::{FRAC_PI_4, PI, TAU};
use std::path::{Path, PathBuf};

/// The radiance of the sky.
#[derive(Debug, Clone, PartialEq)]
pub enum Sky {
    /// The same radiance everywhere, W/(m² sr).
    Uniform(Rgb),
    /// An equirectangular picture of radiances, .hdr or .exr, with −Z in the middle, +X to the right of it, and +Y at
    /// the top.
    Picture(PathBuf),
}

/// Distance of the cube's sides, in sizes of the scene: directions differ by less than 1e-3.
const SKY_DISTANCE: f64 = 1e3;

/// The sky's cells around a scene of this centre and size, metres.
pub fn dome(centre: DVec3, size: f64) -> Geometry {
    let mut faces = Vec::new();
    let mut elements = Vec::new();
    for axis in 0..3 {
        for sign in [1.0, -1.0] {
            // Corners run counter-clockwise seen from inside.
            let (n, u) = (DVec3::AXES[axis] * sign, DVec3::AXES[(axis + 1) % 3]);
            let v = u.cross(n);
            let at = |s: f64, t: f64| centre + (n + u * s + v * t) * (SKY_DISTANCE * size);
            let face = FaceId(faces.len() as u32);
            faces.push(Face::new(vec![at(-1.0, -1.0), at(1.0, -1.0), at(1.0, 1.0), at(-1.0, 1.0)]));
            let line = |k: usize| (FRAC_PI_4 * (2.0 * k as f64 / SKY_CELLS as f64 - 1.0)).tan();
            for j in 0..SKY_CELLS {
                for i in 0..SKY_CELLS {
                    let [(s0, t0), (s1, t1)] = [(line(i), line(j)), (line(i + 1), line(j + 1))];
                    let corners = Corners::quad([at(s0, t0), at(s1, t0), at(s1, t1), at(s0, t1)]);
                    elements.push(Element::new(corners, MaterialId(0), face));
                }
            }
        }
    }
    let (order, clusters) = hierarchy(&elements);
    Geometry { elements: order.into_iter().map(|i| elements[i]).collect(), faces, clusters, patches: None }
}

/// The cells of the sky by number: the six sides of the cube, each row by row, in the order in which [`dome`] makes them.
#[derive(Debug)]
pub struct SkyCells;

impl SkyCells {
    /// Number of cells.
    pub const COUNT: usize = 6 * SKY_CELLS * SKY_CELLS;

    /// The cell in this direction.
    pub fn towards(direction: DVec3) -> usize {
        let axis = direction.abs().max_position();
        let sign = direction[axis].signum();
        let (n, u) = (DVec3::AXES[axis] * sign, DVec3::AXES[(axis + 1) % 3]);
        let v = u.cross(n);
        let cell = |along: DVec3| {
            let angle = (direction.dot(along) / direction.dot(n)).atan();
            let place = (angle / FRAC_PI_4 + 1.0) / 2.0 * SKY_CELLS as f64;
            (place.max(0.0) as usize).min(SKY_CELLS - 1)
        };
        let side = 2 * axis + usize::from(sign < 0.0);
        (side * SKY_CELLS + cell(v)) * SKY_CELLS + cell(u)
    }

    /// What a sky sends from each cell, W/m², from what it sends from the elements of its dome around `centre`.
    pub fn radiosity(dome: &Geometry, sends: &[Rgb], centre: DVec3) -> Vec<Rgb> {
        let mut cells = vec![Rgb::BLACK; Self::COUNT];
        for (cell, &radiosity) in dome.elements.iter().zip(sends) {
            cells[Self::towards(cell.centroid - centre)] = radiosity;
        }
        cells
    }
}

/// The loaded radiances of a sky, W/(m² sr).
#[derive(Debug)]
pub enum Radiances {
    /// The same radiance everywhere.
    Uniform(Rgb),
    /// By direction.
    Picture(Picture),
}

impl Sky {
    /// The picture's file, if the sky is a picture.
    pub fn file(&self) -> Option<&Path> {
        match self {
            Self::Uniform(_) => None,
            Self::Picture(file) => Some(file),
        }
    }

    /// Load the radiances. Fails if the picture cannot be read.
    pub fn read(&self) -> Result<Radiances> {
        Ok(match self {
            Self::Uniform(radiance) => Radiances::Uniform(*radiance),
            Self::Picture(file) => Radiances::Picture(Picture::read(file)?),
        })
    }
}

impl Radiances {
    /// The radiosity of each cell of a dome around `centre`, W/m².
    pub fn radiosity(&self, dome: &Geometry, centre: DVec3) -> Vec<Rgb> {
        let radiance = |cell: &Element| match self {
            Self::Uniform(radiance) => *radiance,
            Self::Picture(picture) => picture.average(cell, centre),
        };
        dome.elements.iter().map(|cell| radiance(cell).map(|l| PI * l)).collect()
    }
}

/// Load the picture in `file`. A Radiance file begins with `#?RADIANCE` or, from many programs, with `#?RGBE`; the
/// strict decoder accepts only the first.
fn open(file: &Path) -> ImageResult<DynamicImage> {
    let reader = ImageReader::open(file)?.with_guessed_format()?;
    match reader.format() {
        Some(ImageFormat::Hdr) => DynamicImage::from_decoder(HdrDecoder::new_nonstrict(reader.into_inner())?),
        _ => reader.decode(),
    }
}

/// Radiances by direction.
#[derive(Debug)]
pub struct Picture {
    width: usize,
    height: usize,
    pixels: Vec<[f32; 3]>,
}

impl Picture {
    fn read(file: &Path) -> Result<Self> {
        let expected = "an equirectangular picture, .hdr or .exr, with finite numbers of 0 or more";
        let wrong = |found: String| Error::new(file, found, expected, "convert the picture, or give another");
        let image = open(file).map_err(|error| wrong(format!("could not be read ({error})")))?.into_rgb32f();
        let pixels: Vec<[f32; 3]> = image.pixels().map(|pixel| pixel.0).collect();
        if pixels.iter().flatten().any(|l| !l.is_finite() || *l < 0.0) {
            return Err(wrong("a pixel that is negative or no number".into()));
        }
        Ok(Self { width: image.width() as usize, height: image.height() as usize, pixels })
    }

    /// The mean radiance over a cell, from points about as dense as the pixels.
    fn average(&self, cell: &Element, centre: DVec3) -> Rgb {
        let points = (self.width / (4 * SKY_CELLS)).clamp(4, 64);
        let &[a, b, c, d] = cell.corners.as_slice() else { unreachable!("cells have four corners") };
        let (mut sum, mut total) = (Rgb::BLACK, 0.0);
        for k in 0..points * points {
            let [s, t] = [k % points, k / points].map(|n| (n as f64 + 0.5) / points as f64);
            let p = a * (1.0 - s) * (1.0 - t) + b * s * (1.0 - t) + c * s * t + d * (1.0 - s) * t - centre;
            // Proportional to the solid angle of a piece of the plane.
            let weight = p.length().powi(-3);
            let radiance = self.at(p);
            (0..3).for_each(|channel| sum[channel] += weight * f64::from(radiance[channel]));
            total += weight;
        }
        sum / total
    }

    fn at(&self, to: DVec3) -> [f32; 3] {
        let (u, v) = (0.5 + to.x.atan2(-to.z) / TAU, (to.y / to.length()).clamp(-1.0, 1.0).acos() / PI);
        let x = ((u * self.width as f64) as usize).min(self.width - 1);
        let y = ((v * self.height as f64) as usize).min(self.height - 1);
        self.pixels[y * self.width + x]
    }
}
