//! A row several times over, by independent sets of its rays: how far they differ is how uncertain the row is.

use super::samples::Samples;
use super::scenery::{Landing, Scenery};
use super::surfaces::End;
use equilux_formats::Rgb;
use glam::DVec3;

/// Irradiance of a row, W/m², as several independent sets of its rays find it: the mean over the rays of `light` of what they end
/// on and their direction in the scene.
pub fn replicas<const N: usize>(
    scenery: &Scenery,
    samples: &Samples,
    (instance, unknown): (usize, usize),
    light: impl Fn(Option<Landing>, DVec3) -> Rgb,
) -> [Rgb; N] {
    let emitters = scenery.surfaces_of(instance).emitters(unknown);
    let (near, placement) = (emitters.bounds().diagonal(), scenery.placement_of(instance));
    std::array::from_fn(|replica| {
        let mut rays = Vec::new();
        emitters.rays(samples, emitters.number() ^ (replica as u32) << 28, &mut rays);
        let (mut sum, mut open) = (Rgb::BLACK, 0.0);
        for ray in &rays {
            let landing = scenery.land(instance, ray, near);
            if landing.is_none_or(|landing| landing.end != End::Covered) {
                sum += light(landing, placement.transform_vector3(ray.direction));
                open += 1.0;
            }
        }
        if open > 0.0 { sum / open } else { sum }
    })
}
