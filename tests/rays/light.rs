//! The light that rows by rays carry.

use super::solved;
use equilux_assemble::proof::audit::audit;
use equilux_assemble::proof::noise::noise;
use equilux_assemble::proof::sample::ExactRows;
use equilux_assemble::solve::Solved;
use equilux_bake::equilibrium::apply;
use equilux_bake::monitor::Monitor;
use equilux_formats::{Corners, LightKind, LightUnits, MaterialId, Part, PunctualLight, Rgb, Surface};
use equilux_tests::curved::{sphere, torus};
use equilux_tests::levels::furnished;
use equilux_tests::shapes::{grey, part, room, scene_of, solid};
use glam::{DVec3, dvec3};

/// A mesh of these triangles, moved.
fn mesh(triangles: Vec<[DVec3; 3]>, by: DVec3) -> Part {
    let mut mesh = part(grey(0.6, 0.0));
    let moved = triangles.into_iter().map(|triangle| Corners::triangle(triangle.map(|p| p + by)));
    mesh.surfaces.extend(moved.map(|corners| Surface::new(corners, MaterialId(0))));
    mesh
}

/// A room of 3 × 2 × 3 m with a ball and a ring of small triangles, and a crate on the floor, all of one reflectance.
fn room_with_meshes(reflectance: f64, emission: f64) -> Vec<Part> {
    let mut parts = vec![
        room(grey(0.0, 0.0), DVec3::ZERO, dvec3(3.0, 2.0, 3.0)),
        mesh(sphere(0.4, 3), dvec3(0.8, 1.0, 0.8)),
        mesh(torus((0.4, 0.1), 48, 16), dvec3(2.2, 0.7, 1.0)),
        solid(grey(0.0, 0.0), dvec3(1.6, 0.0, 1.9), dvec3(2.23, 0.5, 2.41)),
    ];
    parts.iter_mut().for_each(|part| part.materials[0] = grey(reflectance, emission));
    parts
}

/// The share of the emitted power that is absorbed, red.
fn closure(solved: &Solved) -> f64 {
    let energy = &solved.outcome.convergence.energy;
    energy.absorbed[0] / energy.emitted[0]
}

/// Every ray of a closed scene ends on an element, and sums of whole numbers are exact: B = E/(1 − ρ) to rounding, for patches of
/// meshes and where the crate covers the floor, too.
#[test]
fn a_furnace_has_one_radiosity() {
    let solved = solved(&scene_of(room_with_meshes(0.75, 1.0)), 0.25, 64);
    let elements = solved.elements().iter().zip(solved.radiosity());
    // Elements that the crate covers whole are dark and in nobody's sight.
    let is_under = |p: DVec3| p.y < 1e-6 && p.x > 1.6 && p.x < 2.23 && p.z > 1.9 && p.z < 2.41;
    let seen = elements.filter(|(element, _)| !is_under(element.centroid));
    let worst = seen.map(|(_, b)| (b[0] - 4.0).abs()).fold(0.0, f64::max);
    // The exchange is proved to a millionth of the brightest.
    assert!(worst <= 4e-6, "{worst} off 4 W/m²");
}

/// The rows themselves leave nothing of E − (I − ρF) B for B = E/(1 − ρ): sums of whole numbers, and some roundings of 4 W/m².
#[test]
fn a_furnace_solves_the_equation_to_rounding() {
    let solved = solved(&scene_of(room_with_meshes(0.75, 1.0)), 0.25, 64);
    let columns = vec![Rgb([4.0; 3]); solved.equation.placed.columns()];
    for system in solved.equation.systems() {
        let own = &columns[..system.self_block.senders()];
        let arriving = apply(system.self_block, own).into_iter().zip(apply(system.coupling, &columns));
        let sums = (0..).map(|k| system.self_block.row_sum(k) + system.coupling.row_sum(k));
        for (residual, sum) in arriving.map(|(own, others)| 1.0 + 0.75 * (own + others)[0] - 4.0).zip(sums) {
            // An element that a crate covers whole has no rays.
            assert!(sum == 0.0 || residual.abs() <= 1e-12, "{residual} W/m² with a row sum of {sum}");
        }
    }
}

/// Small triangles become patches of about the size of elements: their number does not follow the mesh.
#[test]
fn a_dense_mesh_has_as_many_unknowns_as_its_area_asks_for() {
    let unknowns = |level: usize| {
        let scene = scene_of(vec![mesh(sphere(0.5, level), DVec3::ZERO)]);
        let solved = solved(&scene, 0.2, 64);
        (solved.elements().len(), solved.equation.placed.unknowns_of(0))
    };
    let (coarse, fine) = (unknowns(3), unknowns(5));
    assert_eq!(fine.0, 16 * coarse.0, "elements are triangles");
    // π m² in patches of at most 0.2 m: 79 squares. Patches that grow from seeds are about half as large.
    for (elements, unknowns) in [coarse, fine] {
        assert!((79..=240).contains(&unknowns), "{unknowns} unknowns of {elements} elements");
    }
}

/// What lamps send is absorbed: rows by rays lose nothing, nor do the form factors of lamps, near a mesh, a crate on the floor
/// or a lamp close under a ceiling.
#[test]
fn closed_rooms_absorb_what_lamps_emit() {
    for gap in [0.5, 0.02] {
        let mut parts = room_with_meshes(0.5, 0.0);
        let lamp = (dvec3(1.2, 1.9 - gap, 1.2), dvec3(1.8, 2.0 - gap, 1.8));
        parts.push(solid(grey(0.5, 10.0), lamp.0, lamp.1));
        let closure = closure(&solved(&scene_of(parts), 0.2, 256));
        // Noise of the mean over about a thousand unknowns, from lamps and from rows. Measured: .1 %.
        assert!((closure - 1.0).abs() <= 2e-3, "{closure} of the power absorbed, {gap} m under the ceiling");
    }
}

/// More rays bring light that differs from less by as much as the noise of these says, and by nothing on average.
#[test]
fn noise_is_what_was_measured_and_has_no_mean() {
    let scene = scene_of(furnished(1));
    let (few, many) = (solved(&scene, 0.4, 64), solved(&scene, 0.4, 4096));
    let measured = noise(&few.equation, few.radiosity(), &few.irradiance).expect("rays").whole.over_mean;
    let (mut square, mut shift, mut sum) = (0.0, 0.0, 0.0);
    for ((element, a), b) in few.elements().iter().zip(&few.irradiance).zip(&many.irradiance) {
        square += element.area * (a[0] - b[0]).powi(2);
        shift += element.area * (a[0] - b[0]);
        sum += element.area * b[0];
    }
    let area: f64 = few.elements().iter().map(|element| element.area).sum();
    let (rms, shift) = ((square / area).sqrt() / (sum / area), shift / sum);
    // The standard error of a few hundred rows is known to some 5 %, and light of lamps has noise of its own.
    assert!((0.6..=1.6).contains(&(rms / measured)), "RMS {rms}, measured {measured}");
    // 4 % of noise in some 700 rows is .15 % of their mean, and reflections carry it on: three times that. Measured: .23 %.
    assert!(shift.abs() <= 5e-3, "mean shift {shift}");
}

/// Exact rows at places all over elements find what many rays find, differ from few rays by the noise of these, and see an error
/// that rows share.
#[test]
fn an_audit_finds_the_noise_and_the_bias_of_rows_by_rays() {
    let audited = |solved: &Solved, shift: f64| {
        let irradiance: Vec<Rgb> = solved.irradiance.iter().map(|&h| h * (1.0 + shift)).collect();
        let rows = ExactRows::About(300);
        audit(&solved.equation, solved.radiosity(), &irradiance, rows, &Monitor::default()).expect("rays")
    };
    let scene = scene_of(furnished(1));
    let (few, many) = (solved(&scene, 0.4, 64), solved(&scene, 0.4, 4096));
    let measured = noise(&few.equation, few.radiosity(), &few.irradiance).expect("rays").whole.over_mean;
    let (of_few, of_many) = (audited(&few, 0.0), audited(&many, 0.0));
    // Light of lamps has noise of its own, and 16 places on an element see the edges of shadows roughly.
    assert!((0.6..=2.0).contains(&(of_few.rms_over_mean / measured)), "{of_few:?}, measured {measured}");
    assert!(of_many.rms_over_mean < 0.5 * of_few.rms_over_mean, "{of_many:?} beside {of_few:?}");
    assert!(of_many.bias_over_mean.abs() <= 5e-3, "{of_many:?}");
    let shifted = audited(&many, -0.05).bias_over_mean - of_many.bias_over_mean;
    assert!((shifted + 0.05).abs() <= 1e-3, "{shifted} of 5 %");
}

/// A point light by shadow rays: in a closed black room all of its power arrives.
#[test]
fn a_point_light_delivers_its_power() {
    let mut scene = scene_of(room_with_meshes(0.0, 0.0));
    scene.lights.push(PunctualLight {
        name: "lamp".into(),
        position: dvec3(1.1, 1.7, 2.2),
        direction: DVec3::NEG_Y,
        intensity: Rgb::splat(1.0),
        units: LightUnits::Radiometric,
        kind: LightKind::Point,
        angle: 0.0,
    });
    let solved = solved(&scene, 0.2, 64);
    let arriving = solved.irradiance.iter().zip(solved.elements());
    let power: f64 = arriving.map(|(h, element)| h[0] * element.area).sum();
    let expected = 4.0 * std::f64::consts::PI;
    // 64 places an unknown find the shadows' edges; the floor that the crate covers counts as lit as the rest of its elements.
    assert!((power / expected - 1.0).abs() <= 0.01, "{power} W of {expected}");
}
