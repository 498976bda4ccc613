//! The light of texels. Input: texels with their footprints and a solved scene. Output: the irradiance of each texel.
//!
//! Direct light is averaged over the footprint; reflected light is gathered at as many texels as needed and
//! interpolated elsewhere.

use super::field::interpolated;
use super::texels::{Texel, TexelFootprint, Texels};
use crate::gather::Gather;
use crate::gather::faces::CoplanarFaces;
use crate::gather::surface_piece::SurfacePiece;
use equilux_formats::Rgb;
use glam::DVec3;

/// Maximum error of interpolation in the middle of a square, relative to the value there or to a tenth of the mean
/// light.
const MAX_INTERPOLATION_ERROR: f64 = 0.01;

/// Maximum error of an interpolated direction along each axis.
const MAX_DIRECTION_ERROR: f64 = 0.01;

/// Computes the light of texels.
#[derive(Debug)]
pub struct TexelLight<'a> {
    gather: &'a Gather,
    /// The scene's mean irradiance, W/m².
    mean: Rgb,
}

impl<'a> TexelLight<'a> {
    /// Light from `gather`; `mean` is the scene's mean irradiance, W/m².
    pub fn new(gather: &'a Gather, mean: Rgb) -> Self {
        Self { gather, mean }
    }

    /// The irradiance of each texel, W/m².
    pub fn irradiance(&self, texels: &Texels) -> Vec<Rgb> {
        let planes = self.planes(texels);
        let direct = self.direct(texels, &planes);
        let reflected = self.reflected(texels, &planes);
        direct.into_iter().zip(reflected).map(|(a, b)| a + b).collect()
    }

    /// The faces in the plane of each patch, found at a footprint: the corner of its grid may be far away.
    fn planes(&self, texels: &Texels) -> Vec<CoplanarFaces<'_>> {
        let mut points: Vec<DVec3> = texels.patches.iter().map(|patch| patch.origin).collect();
        for footprint in texels.texels.iter().flat_map(|texel| &texel.footprints) {
            points[footprint.patch] = footprint.corners[0];
        }
        let faces = self.gather.faces();
        points.iter().zip(&texels.patches).map(|(&p, patch)| faces.in_plane(p, patch.normal)).collect()
    }

    fn direct(&self, texels: &Texels, planes: &[CoplanarFaces]) -> Vec<Rgb> {
        let all: Vec<&Texel> = texels.texels.iter().collect();
        means(&all, planes, |pieces| self.gather.direct(pieces, self.mean))
    }

    fn reflected(&self, texels: &Texels, planes: &[CoplanarFaces]) -> Vec<Rgb> {
        let gathered =
            |texels: &[&Texel]| means(texels, planes, |pieces| self.gather.reflected_over(pieces, self.mean));
        interpolated(self.gather, texels, gathered, |corners, interpolated_value, found| {
            let alike = |a: f64, b: f64| a <= 2.0 * b && b <= 2.0 * a;
            self.is_near(interpolated_value, found)
                && corners.iter().all(|corner| (0..3).all(|c| alike(corner[c], found[c])))
        })
    }

    /// For each texel the mean direction of its light, weighted by the luminance of the irradiance from each
    /// direction. The length is 1 where all light comes from one direction, and 0 where light is uniform all around
    /// or absent.
    pub fn directions(&self, texels: &Texels) -> Vec<[f64; 3]> {
        let planes = self.planes(texels);
        let gathered = |texels: &[&Texel]| self.mean_directions(texels, &planes);
        // Directions are interpolated component by component, like light.
        let found = interpolated(self.gather, texels, gathered, |_, interpolated_value, found| {
            (0..3).all(|c| (interpolated_value[c] - found[c]).abs() <= MAX_DIRECTION_ERROR)
        });
        found.into_iter().map(|Rgb(direction)| direction).collect()
    }

    fn mean_directions(&self, texels: &[&Texel], planes: &[CoplanarFaces]) -> Vec<Rgb> {
        let largest = |texel: &&Texel| {
            let by_area = |a: &&TexelFootprint, b: &&TexelFootprint| a.area.total_cmp(&b.area);
            texel.footprints.iter().max_by(by_area).expect("a texel holds some of its chart").clone()
        };
        let footprints: Vec<TexelFootprint> = texels.iter().map(largest).collect();
        let pieces: Vec<SurfacePiece> =
            footprints.iter().map(|footprint| surface_piece(footprint, planes)).collect();
        self.gather.directions(&pieces).into_iter().map(|direction| Rgb(direction.to_array())).collect()
    }

    fn is_near(&self, a: Rgb, b: Rgb) -> bool {
        (0..3).all(|c| (a[c] - b[c]).abs() <= MAX_INTERPOLATION_ERROR * b[c].max(0.1 * self.mean[c]))
    }
}

/// The mean light of each texel's footprints.
fn means(
    texels: &[&Texel],
    planes: &[CoplanarFaces],
    light: impl Fn(&[SurfacePiece]) -> Vec<Rgb>,
) -> Vec<Rgb> {
    let pieces: Vec<SurfacePiece> = texels
        .iter()
        .flat_map(|texel| &texel.footprints)
        .map(|footprint| surface_piece(footprint, planes))
        .collect();
    let mut light = light(&pieces).into_iter();
    let mean = |texel: &&Texel| {
        let sum = texel.footprints.iter().fold(Rgb::BLACK, |sum, footprint| {
            let h = light.next().expect("one value for each piece");
            sum + h * footprint.area
        });
        sum.map(|sum| sum / texel.area())
    };
    texels.iter().map(mean).collect()
}

fn surface_piece<'a>(footprint: &'a TexelFootprint, planes: &'a [CoplanarFaces<'a>]) -> SurfacePiece<'a> {
    SurfacePiece { corners: &footprint.corners, normal: footprint.normal, plane: &planes[footprint.patch] }
}
