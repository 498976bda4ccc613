//! Form factors from a point with a closed form. Each is computed by rows and by the plain kernel, and both must agree.

use equilux_bake::form_factor::plain;
use equilux_bake::treecode::EXACT;
use equilux_bake::world::World;
use equilux_formats::Part;
use equilux_tests::shapes::{coupling, grey, joined, mesh, part, quad, rectangle, triangle};
use glam::{DAffine3, DVec3, dvec3};
use std::f64::consts::PI;

/// A tiny triangle around `point`, looking along `normal`: the receiver.
fn receiver(point: DVec3, normal: DVec3) -> Part {
    let (u, v) = normal.any_orthonormal_pair();
    let corners = [0.0f64, 1.0, 2.0].map(|k| {
        let angle = k * 2.0 * PI / 3.0;
        point + (u * angle.cos() + v * angle.sin()) * 1e-3
    });
    triangle(part(grey(0.5, 0.0)), corners)
}

/// The rectangle from `low` to `high`, which agree in one coordinate; its front looks along `normal`.
fn facing(low: DVec3, high: DVec3, normal: DVec3) -> Part {
    let span = high - low;
    let axes: Vec<DVec3> =
        DVec3::AXES.into_iter().map(|axis| axis * span.dot(axis)).filter(|a| *a != DVec3::ZERO).collect();
    let (u, v) =
        if axes[0].cross(axes[1]).dot(normal) > 0.0 { (axes[0], axes[1]) } else { (axes[1], axes[0]) };
    rectangle(part(grey(0.5, 0.0)), low, u, v)
}

/// Σ F over the elements of the second part seen from the first, with the other parts in the way; by rows, after
/// checking the plain kernel against them.
fn seen(parts: &[Part]) -> f64 {
    let geometries: Vec<_> = parts.iter().map(mesh).collect();
    let world = World::new(geometries.iter().map(|g| (g, DAffine3::IDENTITY)));
    let senders = world.elements_of(1);
    let by_row: f64 = coupling(&world, 0, &[1], EXACT).row_sum(0);
    let by_pair: f64 = senders.map(|sender| plain::form_factor(&world, 0, sender)).sum();
    assert!((by_row - by_pair).abs() <= 1e-15, "row {by_row}, plain {by_pair}");
    by_row
}

fn assert_near(found: f64, expected: f64, tolerance: f64) {
    assert!((found - expected).abs() <= tolerance, "found {found}, expected {expected} ± {tolerance}");
}

#[test]
fn parallel_rectangle_over_its_corner() {
    // Exact in closed form; what is left is the rounding of four edge terms.
    let found =
        seen(&[receiver(DVec3::ZERO, DVec3::Z), facing(dvec3(0., 0., 1.), dvec3(1., 1., 1.), -DVec3::Z)]);
    assert_near(found, 0.138531605994893, 1e-14);
}

#[test]
fn perpendicular_rectangle() {
    let found =
        seen(&[receiver(DVec3::ZERO, DVec3::Z), facing(dvec3(0., 1., 0.), dvec3(1., 1., 1.), -DVec3::Y)]);
    // F = 1/2π [atan(1/Y) − Y/√(X²+Y²) atan(1/√(X²+Y²))] at X = Y = 1.
    assert_near(found, 0.0557341970025, 1e-12);
}

#[test]
fn what_lies_below_the_horizon_is_cut_off() {
    let found =
        seen(&[receiver(DVec3::ZERO, DVec3::Z), facing(dvec3(-1., 1., -5.), dvec3(1., 1., 1.), -DVec3::Y)]);
    assert_near(found, 0.111468394005107, 1e-14);
}

#[test]
fn a_blocker_hides_its_quarter() {
    let found = seen(&[
        receiver(dvec3(0.5, 0.5, 0.), DVec3::Z),
        facing(dvec3(0., 0., 1.), dvec3(1., 1., 1.), -DVec3::Z),
        facing(dvec3(0., 0., 0.5), dvec3(0.5, 0.5, 0.5), DVec3::Z),
    ]);
    assert_near(found, 0.75 * 0.239456470460774, 1e-14);
}

#[test]
fn a_fence_lets_exactly_half_through() {
    let slats = (-8..8).map(|k| {
        let left = f64::from(k) / 16.0;
        facing(dvec3(left, -2., 0.5), dvec3(left + 1.0 / 32.0, 2., 0.5), DVec3::Z)
    });
    let found = seen(&[
        receiver(DVec3::ZERO, DVec3::Z),
        facing(dvec3(-0.5, -0.5, 1.), dvec3(0.5, 0.5, 1.), -DVec3::Z),
        joined(slats),
    ]);
    // Sixteen slats, some 30 pieces: a few hundred roundings.
    assert_near(found, 0.119728235230387, 1e-12);
}

#[test]
fn a_pinhole_is_not_missed() {
    let (hole, wide) = (5e-4, 50.0);
    let plate = [
        (dvec3(-wide, -wide, 1.), dvec3(wide, -hole, 1.)),
        (dvec3(-wide, hole, 1.), dvec3(wide, wide, 1.)),
        (dvec3(-wide, -hole, 1.), dvec3(-hole, hole, 1.)),
        (dvec3(hole, -hole, 1.), dvec3(wide, hole, 1.)),
    ];
    let found = seen(&[
        receiver(DVec3::ZERO, DVec3::Z),
        facing(dvec3(-2., -2., 2.), dvec3(2., 2., 2.), -DVec3::Z),
        joined(plate.map(|(low, high)| facing(low, high, -DVec3::Z))),
    ]);
    assert_near(found / 3.18309780e-7, 1.0, 1e-6);
}

#[test]
fn a_gap_of_a_millionth_lets_out_what_it_should() {
    let found = seen(&[
        receiver(dvec3(0.5, 0.5, 0.), DVec3::Z),
        facing(dvec3(0., 0., 1e-6), dvec3(1., 1., 1e-6), -DVec3::Z),
    ]);
    assert_near(1.0 - found, 3.2732395e-12, 1e-15);
}

#[test]
fn far_away_the_point_to_point_law_holds() {
    // Two tilts, a distance of a million diameters: F → cosθ cosθ' A / πr².
    let at = dvec3(3e5, -4e5, 1.2e6);
    let normal = dvec3(-0.3, 0.4, -0.9).normalize();
    let (u, v) = normal.any_orthonormal_pair();
    let sender = rectangle(part(grey(0.5, 0.0)), at - (u + v) * 0.5, u, v);
    let found = seen(&[receiver(DVec3::ZERO, DVec3::Z), sender]);
    let r = at.length();
    let expected = (at.z / r) * (-normal.dot(at) / r) / (PI * r * r);
    assert_near(found / expected, 1.0, 1e-9);
}

#[test]
fn in_one_plane_or_turned_away_is_exactly_zero() {
    let cases = [
        ("coplanar", facing(dvec3(2., 0., 0.), dvec3(3., 1., 0.), DVec3::Z)),
        ("coplanar, upside down", facing(dvec3(2., 0., 0.), dvec3(3., 1., 0.), -DVec3::Z)),
        ("turned away", facing(dvec3(0., 0., 1.), dvec3(1., 1., 1.), DVec3::Z)),
        ("seen edge-on", facing(dvec3(0., 0., 1.), dvec3(0., 1., 2.), DVec3::X)),
        ("below the horizon", facing(dvec3(0., 0., -1.), dvec3(1., 1., -1.), DVec3::Z)),
    ];
    for (name, sender) in cases {
        assert_eq!(seen(&[receiver(DVec3::ZERO, DVec3::Z), sender]), 0.0, "{name}");
    }
}

#[test]
fn slivers_keep_their_digits() {
    // The closed form of the rectangle over its corner, at a = 1e-6, b = 1, c = 1, in its small-a limit:
    // a/2π · [1/√(1+..)...] is evaluated here as the difference quotient in 40 digits: F(1e-6, 1, 1).
    let (x, y) = (1e-6f64, 1.0f64);
    let term = |a: f64, b: f64| a / (1.0 + a * a).sqrt() * (b / (1.0 + a * a).sqrt()).atan();
    let expected = (term(x, y) + term(y, x)) / (2.0 * PI);
    let found =
        seen(&[receiver(DVec3::ZERO, DVec3::Z), facing(dvec3(0., 0., 1.), dvec3(1e-6, 1., 1.), -DVec3::Z)]);
    assert_near(found / expected, 1.0, 1e-8);
}

#[test]
fn scaling_by_a_power_of_two_changes_no_bit_and_by_a_thousand_hardly_one() {
    let scene = |scale: f64| {
        let parts = [
            receiver(dvec3(0.5, 0.25, 0.), DVec3::Z),
            facing(dvec3(0., 0., 1.), dvec3(1., 1., 1.), -DVec3::Z),
            facing(dvec3(0.1, 0.2, 0.5), dvec3(0.5, 0.7, 0.5), DVec3::Z),
        ];
        let geometries = parts.map(|p| {
            let mut part = p;
            part.surfaces.iter_mut().for_each(|s| s.corners = s.corners.map(|c| c * scale));
            mesh(&part)
        });
        let world = World::new(geometries.iter().map(|g| (g, DAffine3::IDENTITY)));
        coupling(&world, 0, &[1], EXACT).row(0).collect::<Vec<_>>()
    };
    let one = scene(1.0);
    for power in [-30, -10, 10, 30] {
        assert_eq!(scene(2f64.powi(power)), one, "scaled by 2^{power}");
    }
    for scale in [1e-3, 1e3] {
        assert_near(scene(scale)[0].1 / one[0].1, 1.0, 1e-12);
    }
}

#[test]
fn a_disc_behind_a_disc_shows_its_ring() {
    // R²/(R²+h²) − b²/(b²+c²); polygons of m corners converge as m⁻².
    let (outer, h, inner, c) = (2.0, 2.0, 0.5, 1.0);
    let expected = 0.5 - 0.2;
    let disc = |radius: f64, height: f64, m: usize| {
        let at = |k: usize| {
            let angle = 2.0 * PI * k as f64 / m as f64;
            dvec3(radius * angle.cos(), -radius * angle.sin(), height)
        };
        (0..m).fold(part(grey(0.5, 0.0)), |p, k| triangle(p, [dvec3(0., 0., height), at(k), at((k + 1) % m)]))
    };
    let error = |m: usize| {
        let found = seen(&[receiver(DVec3::ZERO, DVec3::Z), disc(outer, h, m), disc(inner, c, m)]);
        (found - expected).abs()
    };
    let (coarse, fine) = (error(16), error(64));
    assert!(fine < coarse / 14.0, "errors {coarse} with 16 corners, {fine} with 64: not second order");
}

#[test]
fn a_quad_between_lists_no_more_than_is_left() {
    // Blocker wholly covering: exactly nothing is left, not a rounded nothing.
    let found = seen(&[
        receiver(dvec3(0.5, 0.5, 0.), DVec3::Z),
        facing(dvec3(0., 0., 1.), dvec3(1., 1., 1.), -DVec3::Z),
        quad(
            part(grey(0.5, 0.0)),
            [dvec3(-1., -1., 0.5), dvec3(2., -1., 0.5), dvec3(2., 2., 0.5), dvec3(-1., 2., 0.5)],
        ),
    ]);
    assert_eq!(found, 0.0);
}
