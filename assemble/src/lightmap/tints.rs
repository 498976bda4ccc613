//! What textures make of each texel. In go texels with their footprints and the coats of the parts; out come the colours by
//! which reflectance and emission are multiplied there.

use super::texels::{Texel, Texels};
use equilux_bake::textures::Coat;
use equilux_formats::{Rgb, Scene};
use glam::{DAffine3, DVec3};

/// Which of the two colours is asked for.
#[derive(Debug, Clone, Copy)]
pub enum TintTarget {
    /// That on the reflectance.
    Reflectance,
    /// That on the emission.
    Emission,
}

/// The coats of the scene's parts; none if nothing is textured.
pub fn coats(scene: &Scene) -> Option<Vec<Coat<'_>>> {
    let textured = scene.parts.iter().any(|part| !part.textured.is_empty());
    textured.then(|| scene.parts.iter().map(|part| Coat::new(&part.materials, &part.textured)).collect())
}

/// The mean colour over each of these texels.
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

/// The mean over a texel's pieces; `back` takes them into the coordinates of their part.
fn tint(texel: &Texel, back: DAffine3, colour: impl Fn(&[DVec3], DVec3) -> Rgb) -> Rgb {
    let sum = texel.pieces.iter().fold(Rgb::BLACK, |sum: Rgb, piece| {
        let corners: Vec<DVec3> = piece.corners.iter().map(|&p| back.transform_point3(p)).collect();
        let colour = colour(&corners, back.transform_vector3(piece.normal).normalize());
        sum + colour * piece.area
    });
    sum.map(|sum| sum / texel.area())
}
