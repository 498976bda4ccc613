//! Textures: images, and the triangles of the source mesh with their texture coordinates.

use crate::ids::MaterialId;
use crate::rgb::Rgb;
use glam::{DAffine3, DVec2, DVec3};
use std::sync::Arc;

/// The textures that multiply a material's reflectance and emission.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Textures {
    /// On the reflectance; its alpha is the share of the surface that exists.
    pub reflectance: Option<Arc<Texture>>,
    /// On the emission.
    pub emission: Option<Arc<Texture>>,
}

/// An image, each texel a square of one colour.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Texture {
    /// Columns and rows, at least one of each.
    pub size: [u32; 2],
    /// sRGB-encoded red, green and blue, and linear alpha; rows from the top.
    pub texels: Vec<[u8; 4]>,
    /// The wrap mode beyond the first and last column, and the first and last row.
    pub wrap: [Wrap; 2],
}

/// The wrap mode beyond the edges of an image.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Wrap {
    /// The image repeats.
    Repeat,
    /// The image repeats, mirrored every other time.
    Mirror,
    /// The texels at the edge repeat.
    Clamp,
}

/// A textured triangle of the source mesh. Elements are matched with these triangles by position, so that form factors
/// do not depend on textures.
#[derive(Debug, Clone, PartialEq)]
pub struct TexturedTriangle {
    /// Its material.
    pub material: MaterialId,
    /// Corners, counter-clockwise seen from the front, metres.
    pub corners: [DVec3; 3],
    /// Vertex colours, which multiply the reflectance, linear RGB.
    pub colours: [Rgb; 3],
    /// Texture coordinates of the corners in the texture on the reflectance; (0, 0) is the upper left corner, (1, 1)
    /// the lower right.
    pub reflectance_at: Option<[DVec2; 3]>,
    /// Texture coordinates of the corners in the texture on the emission.
    pub emission_at: Option<[DVec2; 3]>,
}

impl TexturedTriangle {
    /// The triangle after `placement`. A mirrored placement reverses the order of the corners, so that they stay
    /// counter-clockwise from the front.
    pub fn placed(&self, placement: DAffine3) -> Self {
        let mut placed =
            Self { corners: self.corners.map(|corner| placement.transform_point3(corner)), ..self.clone() };
        if placement.matrix3.determinant() < 0.0 {
            placed.corners.swap(1, 2);
            placed.colours.swap(1, 2);
            placed.reflectance_at.iter_mut().for_each(|places| places.swap(1, 2));
            placed.emission_at.iter_mut().for_each(|places| places.swap(1, 2));
        }
        placed
    }
}
