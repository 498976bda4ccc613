//! Cones of spots have the power that the extension defines, for any sharpness of their edges and size of elements.

use super::{direct, floor, light, of_file, placed};
use equilux_formats::LightKind;
use glam::{DVec3, dvec3};
use std::f64::consts::PI;

/// 2π ∫ I(θ) sin θ dθ of a spot of 1 W/sr: the falloff is 1 up to the inner angle, then the square of a ramp in cos θ.
fn power(inner: f64, outer: f64) -> f64 {
    2.0 * PI * (1.0 - inner.cos() + (inner.cos() - outer.cos()) / 3.0)
}

#[test]
fn a_spot_sends_its_whole_power_onto_what_it_shines_at() {
    for (inner, outer) in [(0.4, 0.4), (0.05, 0.05), (0.02, 0.02), (0.3, 0.4), (0.0, 0.7), (0.0, 0.1)] {
        for size in [4.0, 1.0, 0.25] {
            let scene = placed(vec![floor()], size);
            // Over no corner, edge or middle of any element.
            let at = dvec3(0.13, 2.0, -0.29);
            let spot = light(LightKind::Spot { inner, outer }, at, DVec3::NEG_Y, 1.0);
            let arriving = direct(&scene, &of_file(&scene, &[spot]));
            let found: f64 = scene.placed.world.elements.iter().zip(arriving).map(|(e, h)| e.area * h).sum();
            let expected = power(inner, outer);
            // Edges run through cells of 1/64 of what the cone covers of an element.
            assert!(
                (found / expected - 1.0).abs() < 2e-3,
                "cone {inner} to {outer}, elements of {size} m: {found} W, expected {expected}"
            );
        }
    }
}
