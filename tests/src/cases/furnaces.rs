//! Closed scenes in which everything reflects ρ and emits E: B = E / (1 − ρ) everywhere, whatever the occluders. Errors
//! of form factors show, multiplied by ρ / (1 − ρ).

use super::solve::{Setting, light, solved_file, uniform};
use super::{Case, Finding};
use crate::curved::{sphere, torus};
use crate::model::{Model, Node};
use crate::rooms::half;
use crate::shapes::{fine, grey, joined, moved, part, quad, rectangle, room, self_block, solid, triangle};
use equilux_bake::equilibrium::{LocalSystem, factorise};
use equilux_formats::{LocalSolver, Part, Rgb, Surface};
use glam::{DAffine3, DQuat, DVec3, dvec3};
use serde_json::json;

/// The cases.
pub fn cases() -> Vec<Case> {
    let flat = "corners in f32 lie in a plane within 2e-7, times ρ / (1 − ρ)";
    vec![
        Case::new("furnace, ρ = 0.5", 1e-12, SUMS, || cube_of(0.5)),
        Case::new("furnace, ρ = 0.9", 1e-12, SUMS, || cube_of(0.9)),
        Case::new("furnace, ρ = 0.999", 1e-12, SUMS, || cube_of(0.999)),
        Case::new("furnace, ρ = 1 − 2⁻²⁰", 1e-9, SUMS, || cube_of(1.0 - 2f64.powi(-20))),
        Case::new("furnace with boxes in it", 1e-10, "clipped slivers round worse than whole faces", || {
            turned_boxes(1)
        }),
        Case::new("furnace with boxes in it, in 8 parts", 1e-10, "the same across couplings", || {
            turned_boxes(8)
        }),
        Case::new("furnace with f32 corners turned, in 8 parts", 1e-5, flat, || {
            furnace(&[Node::new("room", furnished(0.9))], &Setting::metres(0.2).cut(8))
        }),
        Case::new(
            "furnace with boxes in it, every local solver",
            1e-12,
            "rows and residual, 1e-14, over 1 − ρ",
            every_solver,
        ),
        Case::new(
            "furnace with a ball and a ring in it",
            1e-11,
            "a row is the sum of some thousand pieces",
            curved,
        ),
    ]
    .into_iter()
    .chain(thin_and_tiny())
    .collect()
}

/// The reason for tolerances at the rounding of row sums.
const SUMS: &str = "the rounding of row sums, 1e-15, times ρ / (1 − ρ)";

fn thin_and_tiny() -> Vec<Case> {
    vec![
        Case::new("furnace with a sheet across it", 1e-12, SUMS, with_sheet),
        Case::new("furnace 1e-6 high", 1e-12, SUMS, || {
            furnace(
                &[Node::new("gap", room(grey(0.9, 1.0), DVec3::ZERO, dvec3(1., 1., 2f64.powi(-20))))],
                &Setting::metres(0.25),
            )
        }),
        Case::new("furnace 1e6 times as long as wide", 1e-12, SUMS, || {
            let duct = room(grey(0.9, 1.0), DVec3::ZERO, dvec3(1024., 2f64.powi(-10), 2f64.powi(-10)));
            furnace(&[Node::new("duct", duct)], &Setting::mesh())
        }),
        Case::new("furnace of slivers", 1e-10, "clipped slivers round worse than whole faces", slivers),
        Case::new("furnace of slivers, in 8 parts", 1e-10, "the same across couplings", || {
            furnace(&[Node::new("duct", duct_of_slivers())], &Setting::metres(0.25).cut(8))
        }),
        Case::new("spherical furnace of 320 facets", 1e-12, SUMS, || {
            furnace(&[ball_room(2)], &Setting::mesh())
        }),
        Case::new("furnace of 6 parts of one element", 1e-12, SUMS, || furnace(&walls(1), &Setting::mesh())),
        Case::new("furnace of 150 parts of one element", 1e-12, SUMS, || {
            furnace(&walls(5), &Setting::mesh())
        }),
        Case::new("furnace with 216 tiny parts in it", 1e-11, "rows of some thousand pieces", tiny_parts),
        Case::new(
            "furnace of 1 km with 1 mm in it",
            1e-11,
            "pieces of a millionth of the room",
            large_and_small,
        ),
        Case::new("furnace of one part and its mirror image", 1e-12, SUMS, mirror_image),
    ]
}

fn furnace(nodes: &[Node], setting: &Setting) -> Finding {
    light(nodes, setting).worst(uniform)
}

fn cube(reflectance: f64) -> Part {
    room(grey(reflectance, 1.0), DVec3::ZERO, DVec3::ONE)
}

fn cube_of(reflectance: f64) -> Finding {
    furnace(&[Node::new("cube", cube(reflectance))], &Setting::metres(0.2))
}

/// A duct of 8 × 1 × 1 m whose long walls are needles, flat triangles and what is left between them.
fn duct_of_slivers() -> Part {
    let mut duct = room(grey(0.9, 1.0), DVec3::ZERO, dvec3(8.0, 1.0, 1.0));
    let is_long =
        |surface: &Surface| (surface.corners.as_slice()[0] - surface.corners.as_slice()[2]).length() > 2.0;
    let (long, ends): (Vec<Surface>, Vec<Surface>) = duct.surfaces.into_iter().partition(is_long);
    duct.surfaces = ends;
    for wall in long {
        // From the end of a short edge on, so that `along` is a long one.
        let mut corners = wall.corners.as_slice().to_vec();
        while (corners[1] - corners[0]).length() < 2.0 {
            corners.rotate_left(1);
        }
        let (from, along, up) = (corners[0], corners[1] - corners[0], corners[3] - corners[0]);
        let at = |s: f64, t: f64| from + along * s + up * t;
        let apex = at(0.375, 0.0625);
        duct = triangle(duct, [at(0.0, 0.0), at(1.0, 0.0), apex]);
        duct = triangle(duct, [at(0.0, 0.0), apex, at(0.0, 1.0)]);
        duct = triangle(duct, [apex, at(1.0, 1.0), at(0.0, 1.0)]);
        for step in 0..8 {
            let [low, high] = [step, step + 1].map(|k| at(1.0, f64::from(k) / 8.0));
            duct = triangle(duct, [apex, low, high]);
        }
    }
    duct
}

fn slivers() -> Finding {
    let duct = duct_of_slivers();
    let solved = light(&[Node::new("duct", duct.clone())], &Setting::metres(0.25));
    // Similar triangles would be 32 × 32 a sliver.
    assert!(solved.elements.len() < 4000, "{} elements", solved.elements.len());
    solved.worst(uniform)
}

/// Two boxes that touch nothing, turned, in the unit cube.
fn furnished(reflectance: f64) -> Part {
    let boxed = |centre: DVec3, axis: DVec3, angle: f64| {
        let turn = DAffine3::from_rotation_translation(DQuat::from_axis_angle(axis, angle), centre);
        moved(solid(grey(reflectance, 1.0), DVec3::splat(-0.1), dvec3(0.1, 0.12, 0.08)), turn)
    };
    let first = boxed(dvec3(0.3, 0.3, 0.35), DVec3::Z, 0.5);
    let second = boxed(dvec3(0.7, 0.3, 0.45), dvec3(1., 1., 0.).normalize(), 1.0);
    joined([first, second, cube(reflectance)])
}

/// Two boxes that are turned by their nodes, which leaves their faces flat to the last digit.
fn turned_boxes(cells: usize) -> Finding {
    let white = || grey(0.9, 1.0);
    let crate_ = solid(white(), DVec3::splat(-0.125), dvec3(0.125, 0.1875, 0.0625));
    let crate_at = |at: DVec3| Node { at, ..Node::new("crate", crate_.clone()) };
    let room = Node::new("room", room(white(), DVec3::ZERO, DVec3::ONE));
    let model =
        Model::of(&[room, crate_at(dvec3(0.3125, 0.3125, 0.375)), crate_at(dvec3(0.6875, 0.3125, 0.5))]);
    let model = model.with("/nodes/1/rotation", json!([0.0, 0.0, 0.28, 0.96]));
    let model = model.with("/nodes/2/rotation", json!([0.48, 0.36, 0.0, 0.8]));
    solved_file(&model, &Setting::metres(0.25).cut(cells))
        .unwrap_or_else(|error| panic!("{error}"))
        .worst(uniform)
}

fn every_solver() -> Finding {
    let geometry = fine(&furnished(0.9), 0.2);
    let block = self_block(&geometry);
    let n = geometry.elements.len();
    let (reflectance, emission) = (vec![Rgb::splat(0.9); n], vec![Rgb::WHITE; n]);
    let solved = |solver: LocalSolver| {
        let factors = factorise(&block, &geometry.clusters, &reflectance, solver);
        LocalSystem::new(&block, &geometry.clusters, &reflectance, solver, factors.as_ref())
            .solve(&emission, &emission)
    };
    use LocalSolver::*;
    let all = [Direct, GaussSeidel, Progressive, Iterative].into_iter().flat_map(solved);
    Finding::worst_relative(all.map(|b| (10.0, b[0])))
}

fn curved() -> Finding {
    let mesh = |triangles: Vec<[DVec3; 3]>, at: DVec3| {
        let part = triangles.into_iter().fold(part(grey(0.9, 1.0)), triangle);
        moved(part, DAffine3::from_translation(at))
    };
    let ring = mesh(torus((0.25, 0.1), 12, 6), dvec3(0.4, 0.5, 0.3));
    let ball = mesh(sphere(0.15, 1), dvec3(0.7, 0.6, 0.7));
    furnace(&[Node::new("room", joined([cube(0.9), ring, ball]))], &Setting::metres(0.25))
}

fn with_sheet() -> Finding {
    let mut paint = grey(0.9, 1.0);
    paint.double_sided = true;
    let corners = [dvec3(0.2, 0.1, 0.3), dvec3(0.9, 0.1, 0.4), dvec3(0.9, 0.8, 0.5), dvec3(0.2, 0.8, 0.4)];
    furnace(&[Node::new("room", joined([cube(0.9), quad(part(paint), corners)]))], &Setting::metres(0.2))
}

fn ball_room(level: usize) -> Node {
    let inside = sphere(1.0, level).into_iter().map(|[a, b, c]| [a, c, b]);
    Node::new("ball", inside.fold(part(grey(0.9, 1.0)), triangle))
}

/// The unit cube, each side in `count`² squares, each a part.
fn walls(count: u32) -> Vec<Node> {
    let step = 1.0 / f64::from(count);
    let sides = cube(0.9).surfaces.into_iter().flat_map(|surface| {
        let c = surface.corners.as_slice();
        let (origin, u, v) = (c[0], (c[1] - c[0]) * step, (c[3] - c[0]) * step);
        (0..count * count)
            .map(move |k| (origin + u * f64::from(k % count) + v * f64::from(k / count), u, v))
            .collect::<Vec<_>>()
    });
    let part = |(origin, u, v)| Node::new("wall", rectangle(part(grey(0.9, 1.0)), origin, u, v));
    sides.map(part).collect()
}

/// One crate in 216 places.
fn tiny_parts() -> Finding {
    let white = || grey(0.9, 1.0);
    let tiny = solid(white(), DVec3::ZERO, DVec3::splat(2f64.powi(-6)));
    let place =
        |k: i32| dvec3(f64::from(k % 6), f64::from(k / 6 % 6), f64::from(k / 36)) + DVec3::splat(1.25);
    let tiny = (0..216).map(|k| Node { at: place(k), ..Node::new(&format!("crate {k}"), tiny.clone()) });
    let room = Node::new("room", room(white(), DVec3::ZERO, DVec3::splat(8.0)));
    furnace(&tiny.chain([room]).collect::<Vec<_>>(), &Setting::metres(2.0))
}

fn large_and_small() -> Finding {
    let white = || grey(0.9, 1.0);
    let tiny = solid(white(), DVec3::ZERO, DVec3::splat(2f64.powi(-10)));
    let at = [dvec3(500., 500., 500.), dvec3(500.0078125, 500., 500.), dvec3(1., 2., 3.)];
    let tiny = at.into_iter().map(|at| Node { at, ..Node::new("crumb", tiny.clone()) });
    let room = Node::new("hall", room(white(), DVec3::ZERO, DVec3::splat(1024.0)));
    furnace(&tiny.chain([room]).collect::<Vec<_>>(), &Setting::metres(256.0))
}

/// Half a room, placed as it stands and mirrored, both three times as large and turned.
fn mirror_image() -> Finding {
    let open = moved(half(grey(0.9, 1.0), 0.0), DAffine3::from_translation(dvec3(-2., 0., 0.)));
    let model = Model::of(&[Node::new("half", open.clone()), Node::new("image", open)]);
    let turn = [0.0, 0.0, 0.6, 0.8];
    let model = model.with("/nodes/0/scale", json!([3, 3, 3])).with("/nodes/1/scale", json!([-3, 3, 3]));
    let model = model.with("/nodes/0/rotation", json!(turn)).with("/nodes/1/rotation", json!(turn));
    let solved = solved_file(&model, &Setting::metres(0.5)).unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(solved.report.parts.len(), 1, "one part in two places");
    solved.worst(uniform)
}
