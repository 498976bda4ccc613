//! What rays leave dark is named, and exact rows find the light there.

use super::{method, solved};
use equilux_assemble::proof::noise::noise;
use equilux_assemble::report::openings::{DarkParts, dark_parts};
use equilux_assemble::solve::Solved;
use equilux_bake::oven::prepare::RowMethod;
use equilux_formats::{Part, Scene};
use equilux_tests::shapes::{grey, rectangle, room, scene_of, solid};
use glam::{DVec3, dvec3};

/// Two rooms of 2 × 2 × 2 m, a lamp in the first, and a square opening of `hole` metres in the wall without thickness between them.
fn rooms(hole: f64) -> Scene {
    let lamp = solid(grey(0.0, 10.0), dvec3(0.5, 1.5, 0.5), dvec3(1.5, 1.75, 1.5));
    let crate_ = solid(grey(0.5, 0.0), dvec3(0.25, 0.0, 0.25), dvec3(0.75, 0.5, 0.75));
    let mut scene = scene_of(vec![holed(0.0, hole), holed(2.0, hole), lamp, crate_]);
    for (instance, name) in scene.instances.iter_mut().zip(["first", "second", "lamp", "crate"]) {
        instance.name = name.into();
    }
    scene
}

/// A room that starts at x = `from`, with the opening in its wall at x = 2.
fn holed(from: f64, hole: f64) -> Part {
    let mut walls = room(grey(0.5, 0.0), dvec3(from, 0.0, 0.0), dvec3(from + 2.0, 2.0, 2.0));
    walls.surfaces.retain(|surface| surface.corners.as_slice().iter().any(|corner| corner.x != 2.0));
    let (low, high) = (1.0 - hole / 2.0, 1.0 + hole / 2.0);
    let strips = [[0.0, 0.0, 2.0, low], [0.0, high, 2.0, 2.0], [0.0, low, low, high], [high, low, 2.0, high]];
    strips.into_iter().filter(|[y, z, to_y, to_z]| to_y > y && to_z > z).fold(
        walls,
        |walls, [y, z, to_y, to_z]| {
            let (up, along) = (DVec3::Y * (to_y - y), DVec3::Z * (to_z - z));
            let (u, v) = if from == 0.0 { (along, up) } else { (up, along) };
            rectangle(walls, dvec3(2.0, y, z), u, v)
        },
    )
}

fn named(solved: &Solved) -> DarkParts {
    let noise = noise(&solved.equation, solved.radiosity(), &solved.irradiance);
    dark_parts(&solved.equation, &solved.equation.systems(), noise.as_ref())
}

/// Mean irradiance of the elements of an instance, red, W/m².
fn mean(solved: &Solved, instance: usize) -> f64 {
    let elements = solved.equation.placed.world.elements_of(instance);
    let area: f64 = elements.clone().map(|e| solved.elements()[e].area).sum();
    elements.map(|e| solved.elements()[e].area * solved.irradiance[e][0]).sum::<f64>() / area
}

/// The second room has 24 m² of reflectance ½: what enters through the opening is absorbed there, but for what goes back. The
/// underside of the crate on the floor is dark too, but is not named.
#[test]
fn a_room_behind_a_pinhole_is_named_and_exact_rows_light_it() {
    let scene = rooms(1e-3);
    let by_rays = solved(&scene, 0.5, 256);
    let DarkParts { notes, remarks } = named(&by_rays);
    assert_eq!(mean(&by_rays, 1), 0.0, "no ray finds the opening");
    assert!(remarks.is_empty(), "{remarks:?}");
    assert!(matches!(&notes[..], [note] if note.starts_with("no ray joins `second` (4")), "{notes:?}");
    assert!(notes[0].ends_with("give --rows exact --tolerance 0"), "{notes:?}");
    let exact = method(&scene, 0.25, RowMethod::Exact, 0);
    let wall = exact.elements().iter().zip(&exact.irradiance).filter(|(element, _)| {
        element.normal.x < -0.5 && (element.centroid - dvec3(2.0, 1.0, 1.0)).length() < 0.3
    });
    let (sum, area) =
        wall.fold((0.0, 0.0), |(sum, area), (element, h)| (sum + h[0] * element.area, area + element.area));
    let (expected, found) = (sum / area * 1e-6 / (24.0 * 0.5), mean(&exact, 1));
    // Walls of 2 m have 8 × 8 values each, and the wall those around the opening instead of one there.
    assert!((found / expected - 1.0).abs() < 0.1, "{found} W/m², expected {expected}");
    assert!(named(&exact).notes.is_empty());
}

#[test]
fn a_closed_room_is_named_and_one_behind_a_door_is_not() {
    let closed = named(&solved(&rooms(0.0), 0.5, 256)).notes;
    assert!(matches!(&closed[..], [note] if note.starts_with("no ray joins `second` (4")), "{closed:?}");
    let open = named(&solved(&rooms(1.0), 0.5, 256));
    assert!(open.notes.is_empty() && open.remarks.is_empty(), "{open:?}");
}

#[test]
fn a_room_behind_an_opening_that_few_rays_find_is_named() {
    let notes = named(&solved(&rooms(0.04), 0.5, 256)).notes;
    assert!(matches!(&notes[..], [note] if note.starts_with("few rays join `second` (4")), "{notes:?}");
}
