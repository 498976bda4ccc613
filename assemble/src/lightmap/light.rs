//! The light of texels. In go texels with their footprints and a scene in equilibrium; out comes the irradiance of each.
//!
//! Direct light is averaged over the footprint; reflected light is gathered at as many texels as it takes.

use super::field::interpolated;
use super::texels::{Footprint, Texel, Texels};
use crate::gather::Gather;
use crate::gather::faces::CoplanarFaces;
use crate::gather::surface_piece::SurfacePiece;
use equilux_formats::Rgb;
use glam::DVec3;

/// What a square's corners say of its middle may be off by this share of what is there, or of a tenth of the mean light.
const OFF: f64 = 0.01;

/// A direction may be off by this along each axis.
const TURNED: f64 = 0.01;

/// Gives texels their light.
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

    /// One irradiance a texel, W/m².
    pub fn irradiance(&self, texels: &Texels) -> Vec<Rgb> {
        let planes = self.planes(texels);
        let direct = self.direct(texels, &planes);
        let reflected = self.reflected(texels, &planes);
        direct.into_iter().zip(reflected).map(|(a, b)| a + b).collect()
    }

    /// The faces in the plane of each patch, which is where a piece of it lies: the corner of its grid may be far away.
    fn planes(&self, texels: &Texels) -> Vec<CoplanarFaces<'_>> {
        let mut points: Vec<DVec3> = texels.patches.iter().map(|patch| patch.origin).collect();
        for piece in texels.texels.iter().flat_map(|texel| &texel.pieces) {
            points[piece.patch] = piece.corners[0];
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
        interpolated(self.gather, texels, gathered, |corners, told, found| {
            let alike = |a: f64, b: f64| a <= 2.0 * b && b <= 2.0 * a;
            self.is_near(told, found)
                && corners.iter().all(|corner| (0..3).all(|c| alike(corner[c], found[c])))
        })
    }

    /// For each texel the mean direction that its light comes from, each direction weighted by the luminance of the irradiance
    /// that comes from there: as long as 1 where all comes from one, 0 where light is even all around or there is none.
    pub fn directions(&self, texels: &Texels) -> Vec<[f64; 3]> {
        let planes = self.planes(texels);
        let gathered = |texels: &[&Texel]| self.mean_directions(texels, &planes);
        // Directions are interpolated as light is, component by component.
        let found = interpolated(self.gather, texels, gathered, |_, told, found| {
            (0..3).all(|c| (told[c] - found[c]).abs() <= TURNED)
        });
        found.into_iter().map(|Rgb(direction)| direction).collect()
    }

    fn mean_directions(&self, texels: &[&Texel], planes: &[CoplanarFaces]) -> Vec<Rgb> {
        let largest = |texel: &&Texel| {
            let by_area = |a: &&Footprint, b: &&Footprint| a.area.total_cmp(&b.area);
            texel.pieces.iter().max_by(by_area).expect("a texel holds some of its chart").clone()
        };
        let pieces: Vec<Footprint> = texels.iter().map(largest).collect();
        let pieces: Vec<SurfacePiece> = pieces.iter().map(|piece| averaged(piece, planes)).collect();
        self.gather.directions(&pieces).into_iter().map(|direction| Rgb(direction.to_array())).collect()
    }

    fn is_near(&self, a: Rgb, b: Rgb) -> bool {
        (0..3).all(|c| (a[c] - b[c]).abs() <= OFF * b[c].max(0.1 * self.mean[c]))
    }
}

/// The mean light of each texel's pieces.
fn means(
    texels: &[&Texel],
    planes: &[CoplanarFaces],
    light: impl Fn(&[SurfacePiece]) -> Vec<Rgb>,
) -> Vec<Rgb> {
    let pieces: Vec<SurfacePiece> =
        texels.iter().flat_map(|texel| &texel.pieces).map(|piece| averaged(piece, planes)).collect();
    let mut light = light(&pieces).into_iter();
    let mean = |texel: &&Texel| {
        let sum = texel.pieces.iter().fold(Rgb::BLACK, |sum, piece| {
            let h = light.next().expect("a value a piece");
            sum + h * piece.area
        });
        sum.map(|sum| sum / texel.area())
    };
    texels.iter().map(mean).collect()
}

fn averaged<'a>(piece: &'a Footprint, planes: &'a [CoplanarFaces<'a>]) -> SurfacePiece<'a> {
    SurfacePiece { corners: &piece.corners, normal: piece.normal, plane: &planes[piece.patch] }
}
