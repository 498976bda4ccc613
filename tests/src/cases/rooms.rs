//! Rooms with a symmetry: of two lamps that mirror each other, both together make a furnace.

use super::solve::{Lit, Setting, light};
use super::{Case, Finding};
use crate::model::Node;
use crate::shapes::{grey, joined, moved, rectangle, room, solid};
use equilux_formats::{Material, Part, Rgb};
use glam::{DAffine3, DVec3, dvec3};

/// The cases.
pub fn cases() -> Vec<Case> {
    let mirror = "row sums and residual, 1e-14, over 1 − ρ";
    vec![
        Case::new("mirror-image rooms behind a door, ρ = 0.999", 1e-10, mirror, || mirrored(0.25)),
        Case::new("mirror-image rooms behind a pinhole, ρ = 0.999", 1e-10, mirror, || {
            mirrored(2f64.powi(-10))
        }),
        Case::new(
            "black floor and ceiling, walls ρ = 1",
            1e-10,
            "no row loses anything but to them",
            || shaft(1),
        ),
        Case::new(
            "black floor and ceiling, walls ρ = 1, in 8 parts",
            1e-10,
            "the same across couplings",
            || shaft(8),
        ),
        Case::new("a lamp in a sealed box beside a dark one", 0.0, "not a rounded nothing", beside),
        Case::new("black elements among white ones send E", 0.0, "what reflects nothing adds nothing", black),
    ]
}

/// A unit cube at x < 0 with a square hole in the wall at x = 0 and a crate in it.
fn holed(material: Material, hole: f64) -> Part {
    let mut walls = room(material.clone(), dvec3(-1., 0., 0.), dvec3(0., 1., 1.));
    walls.surfaces.retain(|s| s.corners.as_slice().iter().any(|p| p.x != 0.0));
    let (low, high) = (0.5 - hole / 2.0, 0.5 + hole / 2.0);
    let strips = [[0., 0., 1., low], [0., high, 1., 1.], [0., low, low, high], [high, low, 1., high]];
    let walls = strips.into_iter().fold(walls, |walls, [y, z, to_y, to_z]| {
        rectangle(walls, dvec3(0., y, z), DVec3::Z * (to_z - z), DVec3::Y * (to_y - y))
    });
    joined([walls, solid(material, dvec3(-0.75, 0.25, 0.125), dvec3(-0.5, 0.5, 0.375))])
}

/// B(x) + B(x') = E / (1 − ρ), where only one of the two rooms emits E.
fn mirrored(hole: f64) -> Finding {
    let image = moved(holed(grey(0.999, 0.0), hole), DAffine3::from_scale(dvec3(-1., 1., 1.)));
    let nodes = [Node::new("lit", holed(grey(0.999, 1.0), hole)), Node::new("dark", image)];
    let solved = light(&nodes, &Setting::metres(0.25));
    let total = 1.0 / (1.0 - solved.elements[0].reflectance[0]);
    let pairs = sums_with_images(&solved.elements, |p| dvec3(-p.x, p.y, p.z));
    let scale = solved.elements[0].emission[0].max(solved.elements.last().expect("elements").emission[0]);
    Finding::worst_relative(pairs.map(|sum| (total * scale, sum))).after(solved.rounds())
}

/// B(x) + B(x') in the first channel, for all x.
fn sums_with_images(elements: &[Lit], image: impl Fn(DVec3) -> DVec3) -> impl Iterator<Item = f64> {
    elements.iter().map(move |lit| {
        let (place, normal) = (image(lit.centroid), image(lit.normal) - image(DVec3::ZERO));
        let near = |other: &&Lit| other.centroid.distance(place) < 1e-9 && other.normal.dot(normal) > 0.99;
        let other = elements.iter().find(near).expect("each element has a mirror image");
        lit.radiosity[0] + other.radiosity[0]
    })
}

/// B(z) + B(1 − z) = E, for a black floor with E, a black ceiling without, and walls that reflect everything.
fn shaft(cells: usize) -> Finding {
    let walls = room(grey(1.0, 0.0), DVec3::ZERO, DVec3::ONE);
    let keep = |level: Option<f64>, material: Material| {
        let mut part = Part { materials: vec![material], ..walls.clone() };
        part.surfaces.retain(|s| {
            let flat = [0.0, 1.0].into_iter().find(|&z| s.corners.as_slice().iter().all(|p| p.z == z));
            flat == level
        });
        part
    };
    let parts =
        [keep(None, grey(1.0, 0.0)), keep(Some(0.0), grey(0.0, 1.0)), keep(Some(1.0), grey(0.0, 0.0))];
    let solved = light(&[Node::new("shaft", joined(parts))], &Setting::metres(0.125).cut(cells));
    let emission = solved.elements.iter().map(|lit| lit.emission[0]).fold(0.0, f64::max);
    let pairs = sums_with_images(&solved.elements, |p| dvec3(p.x, p.y, 1.0 - p.z));
    Finding::worst_relative(pairs.map(|sum| (emission, sum))).after(solved.rounds())
}

/// Two boxes with a wall's thickness of nothing between them.
fn beside() -> Finding {
    let lit = room(grey(0.9, 1e12), DVec3::ZERO, DVec3::ONE);
    let dark = room(grey(0.9, 0.0), dvec3(1., 0., 0.), dvec3(2., 1., 1.));
    let solved = light(&[Node::new("lit", lit), Node::new("dark", dark)], &Setting::metres(0.25));
    let dark = solved.elements.iter().filter(|lit| lit.centroid.x >= 1.0 && lit.emission[0] == 0.0);
    Finding::worst_absolute(dark.map(|lit| (0.0, lit.radiosity[0]))).after(solved.rounds())
}

/// Two black boxes in a room of ρ = 0.999; one emits 1e24 times as much as the other.
fn black() -> Finding {
    let bright = solid(grey(0.0, 1e12), DVec3::splat(0.25), DVec3::splat(0.375));
    let dim = solid(grey(0.0, 1e-12), DVec3::splat(0.625), DVec3::splat(0.75));
    let room = room(grey(0.999, 0.0), DVec3::ZERO, DVec3::ONE);
    let solved = light(
        &[Node::new("room", room), Node::new("bright", bright), Node::new("dim", dim)],
        &Setting::metres(0.25),
    );
    let black = solved.elements.iter().filter(|lit| lit.reflectance == Rgb::default());
    Finding::worst_relative(black.map(|lit| (lit.emission[0], lit.radiosity[0]))).after(solved.rounds())
}
