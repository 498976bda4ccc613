//! Lengths and light from tiny to huge, alone and side by side: results do not depend on scale.

use super::point::{facing, receiver};
use super::solve::{Lit, Setting, light, uniform};
use super::{Case, Finding};
use crate::model::Node;
use crate::rooms::{furnished, half};
use crate::shapes::{coupling, fine, grey, mesh, moved, room, self_block};
use crate::workshop::Workshop;
use equilux_bake::gltf_import::import_scene;
use equilux_bake::treecode::EXACT;
use equilux_bake::world::World;
use equilux_formats::{Material, Rgb, Rows};
use glam::{DAffine3, DVec3, dvec3};
use serde_json::json;

/// The cases.
pub fn cases() -> Vec<Case> {
    let stop = "asked to stop at 1e-6, of each scene that light cannot leave";
    vec![
        Case::new("lengths × 2^±10, 2^±30", 0.0, "powers of two change no digit", || {
            lengths(&[2f64.powi(-30), 2f64.powi(-10), 2f64.powi(10), 2f64.powi(30)])
        }),
        Case::new("lengths × 1e±3", 1e-12, "corners are rounded anew", || lengths(&[1e-3, 1e3])),
        Case::new(
            "rooms of 1 mm, 1 m, 1 km",
            0.0,
            "powers of two change no digit, through all of a run",
            sizes,
        ),
        Case::new(
            "a million metres from the origin",
            0.0,
            "whole metres are exact there, in f32 too",
            far_away,
        ),
        Case::new("E × 2^±100, 2^-300", 0.0, "powers of two change no digit", || {
            emissions(&[2f64.powi(-300), 2f64.powi(-100), 2f64.powi(100)])
        }),
        Case::new("E × 1e±12", 1e-14, "one rounding of E, and as many as before of all else", || {
            emissions(&[1e-12, 1e12])
        }),
        Case::new("sealed rooms, E = 1e12 and 1e-12", 1e-6, stop, || {
            let rooms = [two_halves(grey(0.9, 1e12), 0.0), two_halves(grey(0.9, 1e-12), 8.0)].concat();
            light(&rooms, &Setting::metres(0.5).to(1e-6)).worst(uniform)
        }),
        Case::new("sealed rooms, ρ = 0.999 dark and 0.1 bright", 1e-6, stop, || {
            let rooms = [two_halves(grey(0.1, 1e12), 0.0), two_halves(grey(0.999, 1e-12), 8.0)].concat();
            light(&rooms, &Setting::metres(0.5).to(1e-6)).worst(uniform)
        }),
        Case::new("red 1e12, blue 1e-12, in one room", 1e-6, "asked to stop at 1e-6, of each colour", || {
            let paint = Material {
                reflectance: Rgb([0.1, 0.5, 0.9]),
                emission: Rgb([1e12, 1.0, 1e-12]),
                ..grey(0.0, 0.0)
            };
            light(&two_halves(paint, 0.0), &Setting::metres(0.5).to(1e-6)).worst(uniform)
        }),
    ]
}

/// A room of two parts that are open to each other.
fn two_halves(material: Material, at: f64) -> Vec<Node> {
    let place = |part| Node { at: DVec3::X * at, ..Node::new("half", part) };
    vec![place(half(material.clone(), 0.0)), place(half(material, 2.0))]
}

/// A view with a blocker, scaled: its row against that of the view as it is.
fn lengths(scales: &[f64]) -> Finding {
    let row = |scale: f64| {
        let parts = [
            receiver(dvec3(0.5, 0.25, 0.), DVec3::Z),
            facing(dvec3(0., 0., 1.), dvec3(1., 1., 1.), -DVec3::Z),
            facing(dvec3(0.1, 0.2, 0.5), dvec3(0.5, 0.7, 0.5), DVec3::Z),
        ];
        let geometries = parts.map(|mut part| {
            part.surfaces.iter_mut().for_each(|s| s.corners = s.corners.map(|c| c * scale));
            mesh(&part)
        });
        let world = World::new(geometries.iter().map(|g| (g, DAffine3::IDENTITY)));
        coupling(&world, 0, &[1], EXACT).row_sum(0)
    };
    let one = row(1.0);
    Finding::worst_relative(scales.iter().map(|&scale| (one, row(scale))))
}

fn sizes() -> Finding {
    let radiosity = |size: f64| {
        let cube = room(grey(0.9, 1.0), DVec3::ZERO, DVec3::splat(size));
        light(&[Node::new("cube", cube)], &Setting::metres(size / 4.0).cut(4))
    };
    let one = radiosity(1.0);
    Finding::worst(
        [-10, 10].map(|power| same_times(&one.elements, &radiosity(2f64.powi(power)).elements, 1.0)),
    )
}

/// `b` against `a` × `factor`, element by element.
fn same_times(a: &[Lit], b: &[Lit], factor: f64) -> Finding {
    assert_eq!(a.len(), b.len(), "as many elements");
    let pairs =
        a.iter().zip(b).flat_map(|(a, b)| (0..3).map(move |c| (a.radiosity[c] * factor, b.radiosity[c])));
    Finding::worst_relative(pairs)
}

fn emissions(factors: &[f64]) -> Finding {
    let solved = |factor: f64| {
        let mut nodes = furnished();
        nodes.iter_mut().for_each(|node| node.extras["emission_scale"] = json!(factor));
        light(&nodes, &Setting::metres(1.0))
    };
    let one = solved(1.0);
    let against = |&factor: &f64| {
        let scaled = solved(factor);
        same_times(&one.elements, &scaled.elements, factor).after(scaled.rounds())
    };
    Finding::worst(factors.iter().map(against))
}

/// The block of a cube far away against that of the cube at the origin.
fn far_away() -> Finding {
    let block_at = |offset: DVec3| -> Rows {
        let there = moved(room(grey(0.5, 0.0), DVec3::ZERO, DVec3::ONE), DAffine3::from_translation(offset));
        let workshop = Workshop::with(&[Node::new("box", there)]);
        let scene = import_scene(&workshop.path("scene.glb")).expect("a scene");
        self_block(&fine(&scene.parts[0], 0.25))
    };
    let same = block_at(dvec3(1e6, -2e6, 3e6)) == block_at(DVec3::ZERO);
    Finding::statement("the same form factors", if same { "the same" } else { "others" }, same)
}
