//! Lookups on both sides of a seam agree.

use super::{lookup, scene};
use equilux_assemble::lightmap::Lightmap;
use equilux_assemble::lightmap::atlas::Atlas;
use equilux_assemble::lightmap::texels::Texels;
use equilux_bake::monitor::Monitor;
use equilux_formats::{Part, Rgb, Scene};
use equilux_tests::shapes::{grey, joined, part, rectangle};
use glam::{DAffine3, DVec3, dvec3};

const TEXEL: f64 = 0.1;

/// A floor of 2 × 1 m whose halves are charts of their own, the right one tilted about the edge x = 1 that they share and,
/// in y, from 0 to `depth`.
fn halves(tilt: f64, depth: f64) -> Part {
    let half = |from: DVec3, u: DVec3, v: DVec3| rectangle(part(grey(0.5, 0.0)), from, u, v);
    let over = DVec3::X * tilt.cos() + DVec3::Z * tilt.sin();
    joined([half(DVec3::ZERO, DVec3::X, DVec3::Y), half(DVec3::X, over, DVec3::Y * depth)])
}

/// The same as a smooth surface: at the common edge, both have the normal in the middle between theirs.
fn smooth_halves(tilt: f64, depth: f64) -> Part {
    let mut part = halves(tilt, depth);
    let normal = |angle: f64| dvec3(-angle.sin(), 0.0, angle.cos());
    let [first, common, second] = [0.0, tilt / 2.0, tilt].map(normal);
    part.surfaces[0].normals = Some([first, common, common, first]);
    part.surfaces[1].normals = Some([common, second, second, common]);
    part
}

/// Light that is brighter on the second chart by `jump`.
fn with_a_jump(texels: &Texels, jump: f64) -> Vec<Rgb> {
    let ramp = |t: &equilux_assemble::lightmap::texels::Texel| f64::from(t.at[1]) * 0.02;
    let jump = 1.0 + jump * f64::from(texels.material.0);
    texels.texels.iter().map(|texel| Rgb::splat(jump + ramp(texel))).collect()
}

/// The largest difference of lookups along the piece of x = 1 that both charts have.
fn disagreement(scene: &Scene, depth: f64, jump: f64) -> f64 {
    let atlas = Atlas::new(scene, Some(TEXEL)).expect("a small atlas");
    let lightmap = Lightmap::new(scene, &atlas, |texels| with_a_jump(texels, jump), &Monitor::default())
        .expect("not stopped");
    let differs = |step: u32| {
        let point = dvec3(1.0, f64::from(step) / 64.0 * depth, 0.0);
        (lookup(&lightmap, 0, 0, point)[0] - lookup(&lightmap, 1, 0, point)[0]).abs()
    };
    (0..=64).map(differs).fold(0.0, f64::max)
}

/// The jump is 1. With equal grids only the finite stiffness is left: half a thousandth. Where texels of the one lie between
/// those of the other, lookups bend at different places, and the correction is as even as it may be, not quite.
#[test]
fn lookups_agree_along_smooth_seams_and_nowhere_else() {
    type Made = fn(f64, f64) -> Part;
    let [bent, edge] = [25f64, 40.0].map(f64::to_radians);
    for (case, made, tilt, depth, jump, low, high) in [
        ("one plane, equal grids", halves as Made, 0.0, 1.0, 1.0, 0.0, 1e-3),
        ("smooth, bent by 25°, equal grids", smooth_halves, bent, 1.0, 0.04, 0.0, 1e-3),
        // Light of 1 and of 2 may change by 0.025 of it.
        ("the same with light that a curve does not explain", smooth_halves, bent, 1.0, 1.0, 0.85, 1.0),
        ("flat, bent by 25°", halves, bent, 1.0, 1.0, 0.9, 1.2),
        ("one plane, grids that do not fit", halves, 0.0, 0.73, 1.0, 0.0, 5e-3),
        ("an edge of 40°", halves, edge, 1.0, 1.0, 0.9, 1.2),
    ] {
        let found = disagreement(&scene(made(tilt, depth), &[DAffine3::IDENTITY]), depth, jump);
        assert!((low..=high).contains(&found), "{case}: lookups differ by {found}, expected {low} to {high}");
    }
}

#[test]
fn instances_that_touch_agree_too() {
    let tile = rectangle(part(grey(0.5, 0.0)), DVec3::ZERO, DVec3::X, DVec3::Y);
    let beside = DAffine3::from_translation(DVec3::X);
    let scene = scene(tile, &[DAffine3::IDENTITY, beside]);
    let atlas = Atlas::new(&scene, Some(TEXEL)).expect("a small atlas");
    let light = |texels: &Texels| vec![Rgb::splat(texels.instance as f64); texels.texels.len()];
    let lightmap = Lightmap::new(&scene, &atlas, light, &Monitor::default()).expect("not stopped");
    let middle = [dvec3(1.0, 0.5, 0.0), dvec3(0.0, 0.5, 0.0)];
    let [left, right] = [0, 1].map(|tile: usize| lookup(&lightmap, tile, 0, middle[tile])[0]);
    assert!((left - right).abs() < 1e-3, "{left} and {right} on the edge between light 0 and 1");
    let far = lookup(&lightmap, 0, 0, dvec3(0.5, 0.5, 0.0))[0];
    assert!(far == 0.0, "half a metre away light is {far}, expected 0 as it was");
}
