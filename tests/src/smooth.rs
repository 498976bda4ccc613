//! Parts whose flat sides stand for smooth surfaces: balls, cylinders, capsules.

use crate::curved::sphere;
use crate::shapes::{grey, part};
use equilux_formats::{Corners, MaterialId, Part, Surface};
use glam::{DVec3, dvec3};
use std::f64::consts::TAU;

/// A part of these flat sides with the normals of their corners.
fn smooth(sides: impl IntoIterator<Item = (Vec<DVec3>, Vec<DVec3>)>) -> Part {
    let surface = |(corners, normals): (Vec<DVec3>, Vec<DVec3>)| Surface {
        normals: Some(std::array::from_fn(|i| normals[i.min(normals.len() - 1)])),
        ..Surface::new(
            match corners[..] {
                [a, b, c] => Corners::triangle([a, b, c]),
                [a, b, c, d] => Corners::quad([a, b, c, d]),
                _ => unreachable!("sides have three or four corners"),
            },
            MaterialId(0),
        )
    };
    Part { surfaces: sides.into_iter().map(surface).collect(), ..part(grey(0.5, 0.0)) }
}

/// A ball of 20 · 4^`level` triangles.
pub fn smooth_ball(radius: f64, level: usize) -> Part {
    smooth(sphere(radius, level).into_iter().map(|corners| (corners.to_vec(), corners.to_vec())))
}

/// A surface of revolution around the z axis, in so many steps, from a profile of radius, height and normal (out, up).
fn revolved(profile: &[[f64; 4]], around: usize) -> Part {
    let turned = |k: usize, out: f64, up: f64| {
        let angle = (k % around) as f64 * TAU / around as f64;
        dvec3(out * angle.cos(), out * angle.sin(), up)
    };
    smooth(profile.windows(2).flat_map(|pair| (0..around).map(move |k| (pair, k))).map(|(pair, k)| {
        let mut corners = vec![(k, pair[0]), (k + 1, pair[0]), (k + 1, pair[1]), (k, pair[1])];
        // A pole is one corner.
        if pair[0][0] == 0.0 {
            corners.remove(0);
        } else if pair[1][0] == 0.0 {
            corners.remove(3);
        }
        let place = |&(k, [out, up, ..]): &(usize, [f64; 4])| turned(k, out, up);
        let normal = |&(k, [.., out, up]): &(usize, [f64; 4])| turned(k, out, up);
        (corners.iter().map(place).collect(), corners.iter().map(normal).collect())
    }))
}

/// The wall of a cylinder around the z axis, from z = 0 on, of so many quads.
pub fn smooth_cylinder(radius: f64, height: f64, around: usize) -> Part {
    revolved(&[[radius, 0.0, 1.0, 0.0], [radius, height, 1.0, 0.0]], around)
}

/// A capsule around the z axis whose half balls have their middles at z = 0 and z = `length`.
pub fn smooth_capsule(radius: f64, length: f64, around: usize) -> Part {
    let rings = around / 4;
    let ring = |k: usize, z: f64| {
        let angle = (k as f64 / rings as f64 - 1.0) * TAU / 4.0;
        let (out, up) =
            if k == 0 || k == 2 * rings { (0.0, angle.sin().round()) } else { (angle.cos(), angle.sin()) };
        [radius * out, z + radius * up, out, up]
    };
    let lower = (0..=rings).map(|k| ring(k, 0.0));
    let upper = (rings..=2 * rings).map(|k| ring(k, length));
    revolved(&lower.chain(upper).collect::<Vec<_>>(), around)
}
