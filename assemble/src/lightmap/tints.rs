//! The effect of textures on each texel. Input: texels with their footprints and the coats of the parts. Output: the
//! factors on reflectance and emission.

use super::texels::{Texel, Texels};
use equilux_bake::textures::Coat;
use equilux_formats::{Rgb, Scene};
use glam::{DAffine3, DVec3};

/// Which of the two factors to compute.
#[derive(Debug, Clone, Copy)]
pub enum TintTarget {
    /// The factor on reflectance.
    Reflectance,
    /// The factor on emission.
    Emission,
}

/// The coats of the scene's parts; none if there are no textures.
pub fn coats(scene: &Scene) -> Option<Vec<Coat<'_>>> {
    let textured = scene.parts.iter().any(|part| !part.textured.is_empty());
    textured.then(|| scene.parts.iter().map(|part| Coat::new(&part.materials, &part.textured)).collect())
}

/// The mean factor over each of these texels.
pub fn tints(scene: &Scene, coats: &[Coat], texels: &Texels, of: TintTarget) -> Vec<Rgb> {
    let instance = &scene.instances[texels.instance];
    let (coat, back) = (&coats[instance.part.index()], instance.placement.inverse());
    texels
        .texels
        .iter()
        .map(|texel| tint(texel, back, |p, n| colour(coat.tint(p, n, texels.material), of)))
        .collect()
}

fn colour((reflectance, emission): (Rgb, Rgb), of: TintTarget) -> Rgb {
    match of {
        TintTarget::Reflectance => reflectance,
        TintTarget::Emission => emission,
    }
}

/// The mean over a texel's footprints; `back` transforms them into the coordinates of their part.
fn tint(texel: &Texel, back: DAffine3, colour: impl Fn(&[DVec3], DVec3) -> Rgb) -> Rgb {
    let sum = texel.footprints.iter().fold(Rgb::BLACK, |sum: Rgb, footprint| {
        let corners: Vec<DVec3> = footprint.corners.iter().map(|&p| back.transform_point3(p)).collect();
        let colour = colour(&corners, back.transform_vector3(footprint.normal).normalize());
        sum + colour * footprint.area
    });
    sum.map(|sum| sum / texel.area())
}
