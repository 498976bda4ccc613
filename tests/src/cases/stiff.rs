//! Scenes that converge slowly: nearly all light is reflected, and parts are open to each other or nearly sealed.

use super::solve::{Setting, Solved, light, uniform};
use super::{Case, Finding};
use crate::model::Node;
use crate::shapes::{grey, joined, part, rectangle, room};
use equilux_formats::{Material, Part, Rgb};
use glam::{DVec3, dvec3};

/// The cases.
pub fn cases() -> Vec<Case> {
    let asked = "asked to stop at 1e-6 of the brightest";
    vec![
        Case::new("ρ = 1 but one black floor, 32 parts", 1e-6, asked, || {
            as_the_floor(&Setting::metres(0.5).cut(32).to(1e-6))
        })
        .within(8),
        Case::new("ρ = 0.999 but one black floor, 32 parts", 1e-6, asked, || {
            let solved =
                light(&[Node::new("tower", tower(0.999))], &Setting::metres(0.5).cut(32).to(1e-6).verified());
            off_the_whole(&solved)
        })
        .within(8),
        Case::new("two nearly sealed chambers in a part, ρ = 0.999", 1e-6, asked, || {
            off_the_whole(&light(&chambers(), &Setting::metres(0.25).to(1e-6).verified()))
        })
        .within(12),
        Case::new("six nearly sealed rooms, ρ = 0.999", 1e-6, asked, || {
            light(&enfilade(1.0), &Setting::metres(0.5).to(1e-6)).worst(uniform)
        }),
        Case::new("a lamp in one of six nearly sealed rooms, ρ = 0.999", 1e-6, asked, || {
            off_the_whole(&light(&enfilade(0.0), &Setting::metres(0.5).to(1e-6).verified()))
        })
        .within(12),
    ]
}

/// Furthest from the classic solution, relative to the brightest radiosity.
fn off_the_whole(solved: &Solved) -> Finding {
    let brightest = solved.elements.iter().flat_map(|lit| lit.radiosity).fold(0.0, f64::max);
    let off = solved.report.verify.as_ref().expect("a comparison").max_abs_diff / brightest;
    Finding::of("the whole-scene solution", format!("{off:.1e} away"), off).after(solved.rounds())
}

/// Only the floor absorbs light, so the radiosity is that of the floor everywhere.
fn as_the_floor(setting: &Setting) -> Finding {
    let solved = light(&[Node::new("tower", tower(1.0))], setting);
    let floor =
        solved.elements.iter().map(|lit| lit.emission).fold(Rgb::BLACK, |a, b| if b > a { b } else { a });
    solved.worst(|_| floor)
}

/// 32 m high, with a black floor that emits.
fn tower(reflectance: f64) -> Part {
    let mut walls = room(grey(reflectance, 0.0), DVec3::ZERO, dvec3(1., 1., 32.));
    walls.surfaces.retain(|s| s.corners.as_slice().iter().any(|p| p.z != 0.0));
    joined([walls, rectangle(part(grey(0.0, 1.0)), DVec3::ZERO, DVec3::X, DVec3::Y)])
}

/// A wall in the plane z = `z`, from (x, 0) to (x + 1, 1), with a square hole of side ⅛ in its middle.
fn holed(part: Part, x: f64, z: f64, up: bool) -> Part {
    let (low, high) = (0.4375, 0.5625);
    let strips = [[0., 0., 1., low], [0., high, 1., 1.], [0., low, low, high], [high, low, 1., high]];
    strips.into_iter().fold(part, |part, [left, near, right, far]| {
        let (u, v) = (DVec3::X * (right - left), DVec3::Y * (far - near));
        let (u, v) = if up { (u, v) } else { (v, u) };
        rectangle(part, dvec3(x + left, near, z), u, v)
    })
}

fn without(mut part: Part, flat: impl Fn(&[DVec3]) -> bool) -> Part {
    part.surfaces.retain(|s| !flat(s.corners.as_slice()));
    part
}

/// Two chambers side by side, one lit, each with a hole in its floor to the hall below.
fn chambers() -> Vec<Node> {
    let floor = |corners: &[DVec3]| corners.iter().all(|p| p.z == 0.0);
    let chamber = |material: Material, x: f64| {
        let walls = room(material, dvec3(x, 0., 0.), dvec3(x + 1., 1., 1.));
        holed(without(walls, floor), x, 0.0, true)
    };
    let hall = without(room(grey(0.999, 0.0), dvec3(0., 0., -1.), dvec3(2., 1., 0.)), floor);
    let hall = holed(holed(hall, 0.0, 0.0, false), 1.0, 0.0, false);
    let chambers = joined([chamber(grey(0.999, 1.0), 0.0), chamber(grey(0.999, 0.0), 1.0)]);
    vec![Node::new("chambers", chambers), Node::new("hall", hall)]
}

/// Six rooms on top of each other, a part each, with holes between them; the lowest emits 1, the others `emission`.
fn enfilade(emission: f64) -> Vec<Node> {
    let storey = |k: usize| {
        let (low, high) = (k as f64, k as f64 + 1.0);
        let material = grey(0.999, if k == 0 { 1.0 } else { emission });
        let inner = |corners: &[DVec3]| {
            let at = |z: f64| corners.iter().all(|p| p.z == z);
            k > 0 && at(low) || k < 5 && at(high)
        };
        let mut walls = without(room(material, dvec3(0., 0., low), dvec3(1., 1., high)), inner);
        if k > 0 {
            walls = holed(walls, 0.0, low, true);
        }
        if k < 5 {
            walls = holed(walls, 0.0, high, false);
        }
        Node::new(&format!("storey {k}"), walls)
    };
    (0..6).map(storey).collect()
}
