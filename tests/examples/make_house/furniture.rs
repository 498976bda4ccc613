//! The parts that stand in rooms. All stand on y = 0 on feet or boards, so that the floor below them sees and is seen;
//! the lamp hangs from it.

use crate::rooms::{named, paint};
use equilux_formats::{Material, Part, Rgb};
use equilux_tests::shapes::{joined, solid};
use glam::{DVec3, dvec3};
use std::f64::consts::PI;

/// A pendant lamp: a warm shade on a thin rod.
pub fn lamp() -> Part {
    let glow = Material { emission: Rgb([1.0, 0.8, 0.56].map(|l| PI * 14.0 * l)), ..paint(0.8, 0.8, 0.8) };
    let shade = block(&glow, dvec3(-0.2, -0.75, -0.2), dvec3(0.2, -0.5, 0.2));
    let rod = block(&paint(0.3, 0.3, 0.3), dvec3(-0.015, -0.5, -0.015), dvec3(0.015, 0.0, 0.015));
    named("lamp", joined([shade, rod]), Some(0.2))
}

/// A table of 1.6 m × 0.9 m.
pub fn table() -> Part {
    let wood = paint(0.62, 0.42, 0.24);
    let top = block(&wood, dvec3(-0.8, 0.7, -0.45), dvec3(0.8, 0.75, 0.45));
    let leg = |x: f64, z: f64| block(&wood, dvec3(x - 0.03, 0.0, z - 0.03), dvec3(x + 0.03, 0.7, z + 0.03));
    let legs = [(-0.72, -0.37), (0.72, -0.37), (-0.72, 0.37), (0.72, 0.37)].map(|(x, z)| leg(x, z));
    named("table", joined([top].into_iter().chain(legs)), Some(0.2))
}

/// An open shelf of 1.5 m × 0.3 m, 1.8 m high, with its back to −z.
pub fn shelf() -> Part {
    let wood = paint(0.75, 0.7, 0.6);
    let side = |x: f64| block(&wood, dvec3(x, 0.0, -0.15), dvec3(x + 0.04, 1.8, 0.15));
    let board = |y: f64| block(&wood, dvec3(-0.71, y, -0.15), dvec3(0.71, y + 0.04, 0.15));
    let boards = [0.02, 0.62, 1.2, 1.76].map(board);
    named("shelf", joined([side(-0.75), side(0.71)].into_iter().chain(boards)), Some(0.2))
}

/// A crate of 0.75 m.
pub fn crate_box() -> Part {
    let wood = paint(0.7, 0.45, 0.2);
    let body = block(&wood, dvec3(-0.375, 0.05, -0.375), dvec3(0.375, 0.75, 0.375));
    let foot = |x: f64, z: f64| block(&wood, dvec3(x, 0.0, z), dvec3(x + 0.06, 0.05, z + 0.06));
    let feet = [(-0.36, -0.36), (0.3, -0.36), (-0.36, 0.3), (0.3, 0.3)].map(|(x, z)| foot(x, z));
    named("crate", joined([body].into_iter().chain(feet)), Some(0.2))
}

/// A block of one material.
pub fn block(material: &Material, low: DVec3, high: DVec3) -> Part {
    solid(material.clone(), low, high)
}
