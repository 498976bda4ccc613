//! Tessellated curved surfaces: spheres and tori, closed, no two triangles in one plane.

use glam::{DVec3, dvec3};
use std::f64::consts::TAU;

/// Corners, counter-clockwise seen from outside.
pub type Triangle = [DVec3; 3];

/// A sphere of 20 · 4^`level` triangles around the origin: an icosahedron whose triangles are cut in four again and
/// again. Every corner lies on the sphere.
pub fn sphere(radius: f64, level: usize) -> Vec<Triangle> {
    let mut triangles = icosahedron();
    for _ in 0..level {
        triangles = triangles.iter().flat_map(|&triangle| quarters(triangle)).collect();
    }
    triangles.iter().map(|triangle| triangle.map(|p| p * radius)).collect()
}

fn icosahedron() -> Vec<Triangle> {
    let height = 0.2f64.sqrt();
    let ring =
        |turn: f64, z: f64| dvec3((turn * TAU / 5.0).cos(), (turn * TAU / 5.0).sin(), z / 2.0) * 2.0 * height;
    let (upper, lower) =
        (|k: usize| ring(k as f64 % 5.0, 1.0), |k: usize| ring((k as f64 + 0.5) % 5.0, -1.0));
    (0..5)
        .flat_map(|k| {
            [
                [DVec3::Z, upper(k), upper(k + 1)],
                [upper(k + 1), upper(k), lower(k)],
                [lower(k), lower(k + 1), upper(k + 1)],
                [DVec3::NEG_Z, lower(k + 1), lower(k)],
            ]
        })
        .collect()
}

fn quarters([a, b, c]: Triangle) -> [Triangle; 4] {
    // Both triangles of an edge add its ends and halve: the same to the bit, whichever comes first.
    let middle = |p: DVec3, q: DVec3| (p + q).normalize();
    let (ab, bc, ca) = (middle(a, b), middle(b, c), middle(c, a));
    [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]
}

/// A torus around the z axis of 2 · `around` · `across` triangles; `radii` are those of the ring and of its tube. Each
/// ring of corners is turned by half a step against the last, so `across` must be even.
pub fn torus(radii: (f64, f64), around: usize, across: usize) -> Vec<Triangle> {
    assert!(across.is_multiple_of(2), "half a step a ring must add up to whole ones, got {across} rings");
    // `along` counts half steps.
    let corner = |along: usize, over: usize| {
        let along = (along % (2 * around)) as f64 * TAU / (2 * around) as f64;
        let over = (over % across) as f64 * TAU / across as f64;
        let out = radii.0 + radii.1 * over.cos();
        dvec3(out * along.cos(), out * along.sin(), radii.1 * over.sin())
    };
    (0..across)
        .flat_map(|j| (0..around).map(move |i| (2 * i + j, j)))
        .flat_map(|(along, over)| {
            let (a, b) = (corner(along, over), corner(along + 2, over));
            let (c, d) = (corner(along + 1, over + 1), corner(along + 3, over + 1));
            [[a, b, c], [b, d, c]]
        })
        .collect()
}
