//! Spheres, where every form factor is a share of area. Facets approach them as h², so two meshes tell the limit.

use super::solve::{Lit, Setting, light};
use super::{Case, Finding};
use crate::curved::sphere;
use crate::model::Node;
use crate::shapes::{grey, joined, part, triangle};
use equilux_formats::{Material, Part};
use glam::DVec3;

/// The cases.
pub fn cases() -> Vec<Case> {
    let facets = "what is left of h² after two meshes";
    vec![
        Case::new("the inner of concentric spheres", 2e-3, facets, || concentric(0.5, 4.0 / 3.0)),
        Case::new("the outer of concentric spheres", 2e-3, facets, || concentric(1.0, 2.0 / 3.0)),
        Case::new("an integrating sphere with a port", 2e-3, facets, port),
    ]
}

/// The mean radiosity of what `chosen` takes, weighted by area.
fn mean(elements: &[Lit], chosen: impl Fn(&Lit) -> bool) -> f64 {
    let (light, area) = elements
        .iter()
        .filter(|lit| chosen(lit))
        .fold((0.0, 0.0), |(light, area), lit| (light + lit.radiosity[0] * lit.area, area + lit.area));
    light / area
}

/// The limit of two meshes, the second with half the edges.
fn limit(coarse: f64, fine: f64) -> f64 {
    (4.0 * fine - coarse) / 3.0
}

fn outside(material: Material, radius: f64, level: usize) -> Part {
    sphere(radius, level).into_iter().fold(part(material), triangle)
}

fn inside(material: Material, radius: f64, triangles: impl IntoIterator<Item = [DVec3; 3]>) -> Part {
    let turned = triangles.into_iter().map(|[a, b, c]| [a, c, b].map(|p| p * radius));
    turned.fold(part(material), triangle)
}

/// r = ½ and 1, ρ = ½ and 0.8, E = 1 and 0: B₁ = 1 + ½ B₂ and B₂ = 0.8 (¼ B₁ + ¾ B₂).
fn concentric(radius: f64, expected: f64) -> Finding {
    let solved = |level: usize| {
        let outer = inside(grey(0.8, 0.0), 1.0, sphere(1.0, level));
        let nodes = [Node::new("inner", outside(grey(0.5, 1.0), 0.5, level)), Node::new("outer", outer)];
        light(&nodes, &Setting::mesh())
    };
    let found = [1, 2].map(|level| {
        let solved = solved(level);
        (mean(&solved.elements, |lit| (lit.centroid.length() - radius).abs() < 0.25), solved.rounds())
    });
    Finding::relative(expected, limit(found[0].0, found[1].0)).after(found[1].1)
}

/// A wall of ρ = 0.98 and E = 1 with a black port of area fraction f: B = E / (1 − ρ (1 − f)).
fn port() -> Finding {
    let ratio = |level: usize| {
        let triangles = sphere(1.0, level);
        let port = |t: &[DVec3; 3]| (t[0] + t[1] + t[2]).z / 3.0 > 0.93;
        let (port, wall): (Vec<_>, Vec<_>) = triangles.into_iter().partition(port);
        let parts = [inside(grey(0.98, 1.0), 1.0, wall), inside(grey(0.0, 0.0), 1.0, port)];
        let elements = light(&[Node::new("sphere", joined(parts))], &Setting::mesh()).elements;
        let area = |port: bool| {
            elements.iter().filter(|lit| (lit.reflectance[0] == 0.0) == port).map(|lit| lit.area).sum::<f64>()
        };
        let fraction = area(true) / (area(true) + area(false));
        let rho = elements.iter().map(|lit| lit.reflectance[0]).fold(0.0, f64::max);
        mean(&elements, |lit| lit.reflectance[0] > 0.0) * (1.0 - rho * (1.0 - fraction))
    };
    Finding::relative(1.0, limit(ratio(2), ratio(3)))
}
