//! Corners that lie in the plane of a sender but for the last digit: cutting there leaves edges without a direction.

use equilux_bake::monitor::Monitor;
use equilux_bake::treecode::{Audience, EXACT, Request, block};
use equilux_bake::world::World;
use equilux_formats::{Geometry, Part};
use equilux_tests::curved::torus;
use equilux_tests::shapes::{fine, grey, mesh, part, quad, room, triangle};
use glam::{DAffine3, DVec3, dvec3};
use proptest::prelude::*;

/// Heights over a table at height zero: in its plane, but for rounding, or clearly not.
fn height() -> impl Strategy<Value = f64> {
    prop_oneof![Just(0.0), Just(1e-17), Just(-1e-17), Just(1e-16), Just(-1e-16), 0.1..0.8f64, -0.8..-0.1f64]
}

fn corner() -> impl Strategy<Value = DVec3> {
    (-0.8..0.8f64, -0.8..0.8f64, height()).prop_map(|(x, y, z)| dvec3(x, y, z))
}

fn two_sided() -> Part {
    let mut material = grey(0.5, 0.0);
    material.double_sided = true;
    part(material)
}

/// The tetrahedron on four corners, seen from outside.
fn tetrahedron([a, b, c, d]: [DVec3; 4]) -> Part {
    let inverted = (b - a).cross(c - a).dot(d - a) > 0.0;
    let sides = [[a, b, c], [a, d, b], [b, d, c], [c, d, a]];
    sides.into_iter().fold(part(grey(0.5, 0.0)), |part, mut side| {
        if inverted {
            side.reverse();
        }
        triangle(part, side)
    })
}

/// Whether a face may lie in the table's plane, where both would send.
fn lies_flat(corners: &[DVec3]) -> bool {
    corners.iter().filter(|p| p.z.abs() < 0.05).count() > 2
}

/// How far the rows of the walls of a room, with a table and `things` in it, are from summing to one.
fn defect(things: &[Part]) -> f64 {
    let walls = fine(&room(grey(0.5, 0.0), DVec3::splat(-1.0), DVec3::ONE), 0.5);
    let side = |x: f64, y: f64| dvec3(x * 0.6, y * 0.6, 0.0);
    let table = quad(two_sided(), [side(-1.0, -1.0), side(1.0, -1.0), side(1.0, 1.0), side(-1.0, 1.0)]);
    let all: Vec<Geometry> = [walls, fine(&table, 0.4)].into_iter().chain(things.iter().map(mesh)).collect();
    let world = World::new(all.iter().map(|geometry| (geometry, DAffine3::IDENTITY)));
    let senders: Vec<usize> = (0..world.instances()).collect();
    let request = Request::new(&world, Audience::Instance(0), &senders, EXACT);
    let rows = block(&request, &Monitor::default()).expect("not stopped");
    rows.row_sums.iter().map(|sum| (sum - 1.0).abs()).fold(0.0, f64::max)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(100))]

    #[test]
    fn what_touches_a_table_hides_no_more_than_it_should(sheet in prop::array::uniform3(corner())) {
        prop_assume!(!lies_flat(&sheet));
        prop_assume!((sheet[1] - sheet[0]).cross(sheet[2] - sheet[0]).length() > 0.02);
        let worst = defect(&[triangle(two_sided(), sheet)]);
        // A row is the sum of some hundred clipped terms of 1e-16 each.
        prop_assert!(worst <= 1e-12, "a sheet: a row sums to 1 within {worst:e}");
    }

    #[test]
    fn solids_that_touch_a_table_hide_no_more_than_they_should(solid in prop::array::uniform4(corner())) {
        prop_assume!(!lies_flat(&solid));
        let [a, b, c, d] = solid;
        prop_assume!((b - a).cross(c - a).dot(d - a).abs() > 0.02);
        let worst = defect(&[tetrahedron(solid)]);
        prop_assert!(worst <= 1e-12, "a solid: a row sums to 1 within {worst:e}");
    }

    #[test]
    fn a_ring_around_a_table_hides_no_more_than_it_should(x in -0.3..0.3f64, y in -0.3..0.3f64, z in height()) {
        // Two of its rings of corners are as high as its middle, but for rounding.
        let ring = torus((0.4, 0.15), 12, 6).into_iter();
        let ring = ring.map(|t| t.map(|p| p + dvec3(x, y, z * 0.2)));
        let worst = defect(&[ring.fold(part(grey(0.5, 0.0)), triangle)]);
        // A row is the sum of some thousand clipped terms of 1e-16 each.
        prop_assert!(worst <= 1e-12, "a ring: a row sums to 1 within {worst:e}");
    }
}
