//! Form factors with a closed form, from a point and averaged over areas. The figures were computed in 40 digits.

use super::point::{facing, receiver, seen};
use super::{Case, Finding};
use crate::shapes::{fine, grey, part, rectangle, room, self_block, triangle};
use glam::{DVec3, dvec3};
use std::f64::consts::PI;

/// The cases.
pub fn cases() -> Vec<Case> {
    let edges = "exact in closed form; left is the rounding of a few edge terms";
    let sliver = "the millionth part of an edge is known to 1e-16 of the edge";
    vec![
        Case::new("a parallel rectangle over its corner", 1e-14, edges, || {
            Finding::absolute(0.138531605994893, from_below(dvec3(0., 0., 1.), dvec3(1., 1., 1.), -DVec3::Z))
        }),
        Case::new("a perpendicular rectangle", 1e-14, edges, || {
            Finding::absolute(
                0.05573419700255351,
                from_below(dvec3(0., 1., 0.), dvec3(1., 1., 1.), -DVec3::Y),
            )
        }),
        Case::new("a rectangle across the horizon", 1e-14, edges, || {
            Finding::absolute(
                0.111468394005107,
                from_below(dvec3(-1., 1., -5.), dvec3(1., 1., 1.), -DVec3::Y),
            )
        }),
        Case::new("1 − F across a gap of 1e-6", 1e-15, "a few roundings of F, which is 1", gap),
        Case::new(
            "a square a million of its sides away",
            1e-9,
            "the law of distance itself errs by (side / distance)²",
            far_away,
        ),
        Case::new("coplanar, turned away, edge-on, below", 0.0, "no light reaches what lies there", unseen),
        Case::new("a sliver of aspect 1e6, over its corner", 1e-8, sliver, || {
            let found = from_below(dvec3(0., 0., 1.), dvec3(1e-6, 1., 1.), -DVec3::Z);
            Finding::relative(2.0457747154583212e-7, found)
        }),
        Case::new("a triangular sliver of aspect 1e6", 1e-8, sliver, || {
            let corners = [dvec3(0., 0., 1.), dvec3(0., 1., 1.), dvec3(1e-6, 0., 1.)];
            Finding::relative(1.2499999999995458e-7, from_origin(&corners))
        }),
        Case::new("a tilted sliver of aspect 1e6", 1e-8, sliver, || {
            let corners = [dvec3(1., 0., 1.), dvec3(1., 1., 1. + 1e-6), dvec3(1., 1., 1.)];
            Finding::relative(2.65258190602448e-8, from_origin(&corners))
        }),
        Case::new("seen by a sliver of aspect 1e6", 1e-14, edges, seen_by_sliver),
        Case::new(
            "opposite faces of a cube, averaged",
            1e-8,
            "what Romberg's scheme leaves at 32 × 32",
            opposite,
        ),
        Case::new(
            "adjacent faces of a cube, averaged",
            1e-8,
            "a quarter of what misses the opposite face",
            adjacent,
        ),
    ]
}

/// Seen from the origin looking up.
fn from_below(low: DVec3, high: DVec3, normal: DVec3) -> f64 {
    seen(&[receiver(DVec3::ZERO, DVec3::Z), facing(low, high, normal)])
}

/// A triangle seen from the origin looking up.
fn from_origin(corners: &[DVec3; 3]) -> f64 {
    seen(&[receiver(DVec3::ZERO, DVec3::Z), triangle(part(grey(0.5, 0.0)), *corners)])
}

fn gap() -> Finding {
    let above = facing(dvec3(0., 0., 1e-6), dvec3(1., 1., 1e-6), -DVec3::Z);
    Finding::absolute(3.273239544724e-12, 1.0 - seen(&[receiver(dvec3(0.5, 0.5, 0.), DVec3::Z), above]))
}

/// Two tilts: F → cosθ cosθ' A / πr².
fn far_away() -> Finding {
    let at = dvec3(3e5, -4e5, 1.2e6);
    let normal = dvec3(-0.3, 0.4, -0.9).normalize();
    let (u, v) = normal.any_orthonormal_pair();
    let sender = rectangle(part(grey(0.5, 0.0)), at - (u + v) * 0.5, u, v);
    let r = at.length();
    let expected = (at.z / r) * (-normal.dot(at) / r) / (PI * r * r);
    Finding::relative(expected, seen(&[receiver(DVec3::ZERO, DVec3::Z), sender]))
}

fn unseen() -> Finding {
    let senders = [
        facing(dvec3(2., 0., 0.), dvec3(3., 1., 0.), DVec3::Z),
        facing(dvec3(2., 0., 0.), dvec3(3., 1., 0.), -DVec3::Z),
        facing(dvec3(0., 0., 1.), dvec3(1., 1., 1.), DVec3::Z),
        facing(dvec3(0., 0., 1.), dvec3(0., 1., 2.), DVec3::X),
        facing(dvec3(0., 0., -1.), dvec3(1., 1., -1.), DVec3::Z),
    ];
    let found = senders.map(|sender| seen(&[receiver(DVec3::ZERO, DVec3::Z), sender]));
    Finding::worst_absolute(found.map(|found| (0.0, found)))
}

fn seen_by_sliver() -> Finding {
    // Its centroid is the origin.
    let thin = 3e-6;
    let corners = [dvec3(-1.5, -thin / 3., 0.), dvec3(1.5, -thin / 3., 0.), dvec3(0., 2. * thin / 3., 0.)];
    let sliver = triangle(part(grey(0.5, 0.0)), corners);
    let found = seen(&[sliver, facing(dvec3(0., 0., 1.), dvec3(1., 1., 1.), -DVec3::Z)]);
    Finding::absolute(0.138531605994893, found)
}

/// The form factors from the floor of the unit cube to its ceiling and to one wall, averaged over the floor's elements.
fn from_the_floor(size: f64) -> (f64, f64) {
    let geometry = fine(&room(grey(0.5, 1.0), DVec3::ZERO, DVec3::ONE), size);
    let block = self_block(&geometry);
    let normal = |i: usize| geometry.elements[i].normal;
    let floor: Vec<usize> = (0..geometry.elements.len()).filter(|&i| normal(i).z > 0.5).collect();
    let to = |side: DVec3| {
        let entries = floor.iter().flat_map(|&i| block.row(i));
        entries.filter(|&(j, _)| normal(j).dot(side) > 0.5).map(|(_, f)| f).sum::<f64>() / floor.len() as f64
    };
    (to(-DVec3::Z), to(DVec3::X))
}

/// The average over elements is the midpoint rule. To the ceiling the integrand is smooth, so its error is a series in
/// h², which Romberg's scheme takes away term by term.
pub fn romberg(levels: impl IntoIterator<Item = f64>) -> f64 {
    let mut column: Vec<f64> = levels.into_iter().collect();
    for power in 1..column.len() as i32 {
        let factor = 4f64.powi(power);
        column = column.windows(2).map(|pair| (factor * pair[1] - pair[0]) / (factor - 1.0)).collect();
    }
    column[0]
}

fn opposite() -> Finding {
    let levels = [4.0, 8.0, 16.0, 32.0].map(|n: f64| from_the_floor(1.0 / n).0);
    Finding::absolute(0.1998248956983874, romberg(levels))
}

/// A wall meets the floor, where the integrand is not smooth; but what misses the ceiling meets one of four walls.
fn adjacent() -> Finding {
    let levels = [4.0, 8.0, 16.0, 32.0].map(|n: f64| from_the_floor(1.0 / n));
    for (ceiling, wall) in levels {
        assert!((ceiling + 4.0 * wall - 1.0).abs() < 1e-12, "ceiling {ceiling}, wall {wall}");
    }
    Finding::absolute(0.2000437760754032, (1.0 - romberg(levels.map(|level| level.0))) / 4.0)
}
