//! Closed solids as modelling programs write them: two-sided or not, wound either way or both, mirrored, scaled. Forms that
//! mean the same have the same light, none lets light through, and no row counts anything twice.

use equilux_formats::{Corners, MaterialId, Part, Rgb, Surface};
use equilux_tests::cases::solve::{Lit, Setting, Solved, light, solved_file, uniform};
use equilux_tests::curved::{sphere, torus};
use equilux_tests::model::{Model, Node};
use equilux_tests::shapes::{grey, moved, part, rectangle, room, solid};
use glam::{DAffine3, DVec3, dvec3};
use serde_json::json;

/// How the polygons of a solid are wound.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Winding {
    Outward,
    Inward,
    /// Every third one faces inwards.
    Mixed,
}

/// A solid in one of its forms.
#[derive(Debug, Clone, Copy)]
struct Form {
    winding: Winding,
    two_sided: bool,
    /// What the node scales by, and its mesh is divided by. Powers of two keep every digit.
    scale: DVec3,
}

const PLAIN: Form = Form { winding: Winding::Outward, two_sided: false, scale: DVec3::ONE };

/// All forms that mean the same as [`PLAIN`].
fn forms() -> impl Iterator<Item = Form> {
    let windings = [
        (Winding::Outward, false),
        (Winding::Outward, true),
        (Winding::Inward, true),
        (Winding::Mixed, true),
    ];
    let mirrored = dvec3(-1.0, 1.0, 1.0);
    let each =
        move |scale| windings.into_iter().map(move |(winding, two_sided)| Form { winding, two_sided, scale });
    let scaled =
        [DVec3::splat(1.0 / 128.0), 8.0 * mirrored].map(|scale| Form { two_sided: true, scale, ..PLAIN });
    each(DVec3::ONE).chain(each(mirrored)).chain(scaled)
}

/// Solids around the origin, convex and not, flat and curved.
fn solids() -> [(&'static str, Part); 4] {
    let white = || grey(0.5, 0.0);
    let triangles = |triangles: Vec<[DVec3; 3]>| {
        let mut whole = part(white());
        let corners = triangles.into_iter().map(Corners::triangle);
        whole.surfaces.extend(corners.map(|corners| Surface::new(corners, MaterialId(0))));
        whole
    };
    [
        ("a box", solid(white(), dvec3(-0.375, -0.25, -0.25), dvec3(0.25, 0.25, 0.5))),
        ("a plus sign", plus(white())),
        ("a ball", triangles(sphere(0.5, 1))),
        ("a ring", triangles(torus((0.5, 0.1875), 12, 6))),
    ]
}

/// A prism over a plus sign of five squares: closed by whole edges, not convex.
fn plus(material: equilux_formats::Material) -> Part {
    let (arm, step) = (0.25, 0.5);
    let (low, high) = (-0.25, 0.25);
    let mut whole = part(material);
    let is_in = |i: i32, j: i32| i.abs() + j.abs() <= 1;
    for (i, j) in (-1..=1).flat_map(|i| (-1..=1).map(move |j| (i, j))).filter(|&(i, j)| is_in(i, j)) {
        let origin = dvec3(f64::from(i) * step - arm, f64::from(j) * step - arm, low);
        let (x, y, z) = (DVec3::X * step, DVec3::Y * step, DVec3::Z * (high - low));
        whole = rectangle(whole, origin, y, x);
        whole = rectangle(whole, origin + z, x, y);
        for (outwards, origin, u, v) in [
            ((-1, 0), origin, z, y),
            ((1, 0), origin + x, y, z),
            ((0, -1), origin, x, z),
            ((0, 1), origin + y, z, x),
        ] {
            if !is_in(i + outwards.0, j + outwards.1) {
                whole = rectangle(whole, origin, u, v);
            }
        }
    }
    whole
}

fn formed(mut solid: Part, form: Form) -> Part {
    let unscaled = DAffine3::from_scale(form.scale.recip());
    for (number, surface) in solid.surfaces.iter_mut().enumerate() {
        let turned = match form.winding {
            Winding::Outward => false,
            Winding::Inward => true,
            Winding::Mixed => number % 3 == 0,
        };
        if turned {
            *surface = surface.flipped();
        }
    }
    solid.materials.iter_mut().for_each(|material| material.double_sided = form.two_sided);
    moved(solid, unscaled)
}

/// A room of three metres around a solid of this form. Both emit `shine`; if that is zero, a lamp lights them.
fn around(solid: &Part, form: Form, shine: f64) -> Solved {
    let white = grey(0.5, shine);
    let mut own = formed(solid.clone(), form);
    own.materials.iter_mut().for_each(|material| material.emission = Rgb([shine; 3]));
    let lamp = rectangle(part(grey(0.5, 8.0)), dvec3(-0.75, 1.25, -0.5), DVec3::X * 1.5, DVec3::Z);
    let mut nodes =
        vec![Node::new("room", room(white, DVec3::splat(-1.5), DVec3::splat(1.5))), Node::new("solid", own)];
    if shine == 0.0 {
        nodes.push(Node::new("lamp", lamp));
    }
    let model = Model::of(&nodes).with("/nodes/1/scale", json!(form.scale.to_array()));
    solved_file(&model, &Setting::metres(1.0)).unwrap_or_else(|error| panic!("{form:?}: {error}"))
}

/// The greatest excess of a row's sum over one.
fn excess(solved: &Solved) -> f64 {
    solved.report.row_sum_defect.excess
}

#[test]
fn forms_of_a_solid_that_mean_the_same_have_the_same_light() {
    for (name, solid) in solids() {
        let plain = around(&solid, PLAIN, 0.0);
        // Two triangles of the ring that make a quad do so only if they are wound alike: mixed up, it has other elements.
        let forms = forms().filter(|form| name != "a ring" || form.winding != Winding::Mixed);
        for form in forms {
            let found = around(&solid, form, 0.0);
            assert!(excess(&found) <= 1e-9, "{name}, {form:?}: rows exceed 1 by {}", excess(&found));
            assert_eq!(
                found.elements.len(),
                plain.elements.len(),
                "{name}, {form:?}: elements on inner sides"
            );
            // By its place: a mirrored solid has its elements in another order.
            for lit in &plain.elements {
                let same = |other: &&Lit| {
                    (other.centroid - lit.centroid).length() < 1e-6 && other.normal.dot(lit.normal) > 0.9
                };
                let twin = found.elements.iter().find(same);
                let twin = twin.unwrap_or_else(|| panic!("{name}, {form:?}: no element at {}", lit.centroid));
                // Sums of rounded clippings; the ball's corners have the digits of f32 only, whichever way they are scaled.
                let off = (twin.radiosity[0] / lit.radiosity[0] - 1.0).abs();
                assert!(
                    off < 1e-9,
                    "{name}, {form:?}: {} for {} at {}",
                    twin.radiosity[0],
                    lit.radiosity[0],
                    lit.centroid
                );
            }
        }
    }
}

#[test]
fn a_furnace_is_uniform_around_and_inside_solids_of_every_form() {
    for (name, solid) in solids() {
        for form in forms() {
            // Everything emits, so that inner sides take part.
            let found = around(&solid, form, 1.0);
            let worst = found.worst(uniform);
            // Corners in f32: the ball and the ring close to 1e-7 only.
            assert!(worst.error < 1e-6, "{name}, {form:?}: {} for {}", worst.got, worst.expected);
        }
    }
}

#[test]
fn light_stays_in_a_closed_room_whatever_the_form_of_its_walls() {
    let size = dvec3(2.0, 1.5, 1.0);
    for form in forms().filter(|form| form.two_sided && form.scale.abs() == DVec3::ONE) {
        let walls = |at: DVec3| {
            let walls = formed(solid(grey(0.8, 0.0), -size / 2.0, size / 2.0), form);
            Node { at, ..Node::new(if at.x == 0.0 { "lit" } else { "dark" }, walls) }
        };
        // Wall to wall, and a lamp in the first one.
        let beside = dvec3(size.x, 0.0, 0.0);
        let lamp = rectangle(part(grey(0.5, 3.0)), dvec3(-0.25, 0.25, -0.25), DVec3::X * 0.5, DVec3::Z * 0.5);
        let ground = rectangle(part(grey(0.5, 0.0)), dvec3(-3.0, -2.0, -3.0), DVec3::Z * 6.0, DVec3::X * 8.0);
        let crate_ = solid(grey(0.7, 0.0), beside - 0.2, beside + 0.2);
        let nodes = [
            walls(DVec3::ZERO),
            walls(beside),
            Node::new("lamp", lamp),
            Node::new("ground", ground),
            Node::new("crate", crate_),
        ];
        let found = light(&nodes, &Setting::metres(0.25));
        assert!(excess(&found) <= 1e-9, "{form:?}: rows exceed 1 by {}", excess(&found));
        let inside = |lit: &Lit| {
            let step = lit.centroid + lit.normal * 1e-3;
            step.abs().cmplt(size / 2.0).all()
        };
        let (lit, dark): (Vec<&Lit>, Vec<&Lit>) = found.elements.iter().partition(|lit| inside(lit));
        assert!(
            lit.iter().all(|lit| lit.radiosity[0] > 0.01),
            "{form:?}: an element beside the lamp is dark"
        );
        let brightest = lit.iter().map(|lit| lit.radiosity[0]).fold(0.0, f64::max);
        for out in dark {
            // No form factor leads there; only the exchange's coarse space, which takes a part as a whole, rounds.
            let off = out.radiosity[0].abs();
            assert!(off <= 1e-16 * brightest, "{form:?}: {off} leaks to {} {}", out.centroid, out.normal);
        }
    }
}
