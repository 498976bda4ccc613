//! The number of elements is known before they are created, for any surfaces.

use equilux_bake::elements::{ElementSize, Panels};
use equilux_formats::{Material, Part};
use equilux_tests::shapes::{grey, joined, moved, part, rectangle, room, triangle};
use glam::{DAffine3, DVec3, dvec3};
use proptest::prelude::*;

/// Triangles of any shape, a rectangle of two that join, leaning parallelograms and a room; some two-sided.
fn any_part() -> impl Strategy<Value = Part> {
    let corner = || prop::array::uniform3(-2.0..2.0_f64).prop_map(DVec3::from_array);
    let sides = (prop::collection::vec((corner(), corner(), corner(), 0.0..1.0_f64), 0..6), any::<bool>());
    sides.prop_map(|(sides, double_sided)| {
        let paint = Material { double_sided, ..grey(0.5, 1.0) };
        let sheets = sides.into_iter().fold(part(paint), |part, (a, b, c, flat)| {
            let triangles = triangle(part, [a, b, a.lerp(b, 0.4).lerp(c, flat * flat)]);
            rectangle(triangles, c, b - a, (b - a) * flat + (c - a) * (1.0 - flat).powi(3))
        });
        let tiles = (0..3).fold(part(grey(0.5, 0.0)), |part, k| {
            rectangle(part, dvec3(f64::from(k), 0.0, 9.0), DVec3::X, DVec3::Y)
        });
        let cube = moved(room(grey(0.5, 1.0), DVec3::ZERO, DVec3::ONE), DAffine3::from_translation(DVec3::Y));
        joined([sheets, tiles, cube])
    })
}

proptest! {
    #[test]
    fn a_part_has_as_many_elements_as_were_counted(part in any_part(), size in 0.1..3.0_f64) {
        for size in [ElementSize::Metres(size), ElementSize::Mesh] {
            let panels = Panels::of(&part, size);
            prop_assert_eq!(panels.elements(), panels.geometry().elements.len() as u128, "{}", size);
        }
    }
}
