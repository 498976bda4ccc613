//! Light at single points: closed forms, and messages about points off all surfaces.

use super::{floor, light, of_file, placed};
use equilux_assemble::gather::Gather;
use equilux_assemble::gather::points::{Place, light as light_at};
use equilux_bake::monitor::Monitor;
use equilux_bake::treecode::EXACT;
use equilux_formats::{LightKind, Rgb};
use equilux_tests::rooms::square;
use equilux_tests::shapes::{grey, part, rectangle};
use equilux_tests::workshop::Workshop;
use glam::{DVec3, dvec3};
use std::fs;

/// Points of the floor.
fn grid() -> Vec<Place> {
    let at = |i: usize| -1.93 + 0.2 * i as f64;
    let point = |k: usize| Place { point: dvec3(at(k % 20), 0.0, at(k / 20)), normal: DVec3::Y };
    (0..400).map(point).collect()
}

/// E = I cosθ/r², and nothing behind a sheet over x < 0 half way up: its shadow ends at the plane through lamp and edge.
#[test]
fn a_point_of_the_floor_gets_the_inverse_square_of_a_lamp_or_nothing() {
    let sheet = rectangle(part(grey(0.0, 0.0)), dvec3(-2.0, 0.75, -2.0), 4.0 * DVec3::Z, 2.0 * DVec3::X);
    let scene = placed(vec![floor(), sheet], 0.5);
    let at = dvec3(0.3, 1.5, 0.1);
    let lights = of_file(&scene, &[light(LightKind::Point, at, DVec3::NEG_Y, 10.0)]);
    let dark: Vec<Rgb> = vec![Rgb::BLACK; scene.placed.world.elements.len()];
    let gather = Gather::new(&scene.placed, &dark, &dark, &lights, EXACT);
    let places = grid();
    let found = light_at(
        |points| gather.irradiance(points),
        &scene.placed.world.elements,
        &places,
        &Monitor::default(),
    )
    .unwrap();
    for (Place { point, .. }, found) in places.iter().zip(found) {
        let to = at - *point;
        // The ray to the lamp is half way up at the middle between the two.
        let is_hidden = (at.x + point.x) / 2.0 < 0.0;
        let expected = if is_hidden { 0.0 } else { 10.0 * to.y / to.length().powi(3) };
        let found = found.expect("a point of the floor").irradiance[0];
        // Rounding; and points are moved onto the floor, which they are on already.
        assert!((found - expected).abs() <= 1e-12 * expected, "at {point}: {found}, expected {expected}");
    }
}

#[test]
fn points_on_no_surface_are_counted_and_have_no_light() {
    let workshop = Workshop::with(&square());
    fs::write(workshop.path("points.csv"), "nx,ny,nz,x,y,z,name\n0,-1,0,0.5,0,0.5,a\n0,-1,0,0.5,7,0.5,b\n")
        .unwrap();
    let ended = workshop.run("assemble", &["scene.glb", "--element-size", "1", "--points", "points.csv"]);
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    assert!(ended.stdout.contains("1 point lies on no surface"), "{}", ended.stdout);
    let table = fs::read_to_string(workshop.path("out/scene/points.csv")).unwrap();
    let lines: Vec<&str> = table.lines().collect();
    assert!(lines[1].starts_with("0.5,0,0.5,0,-1,0,") && !lines[1].ends_with(','), "{}", lines[1]);
    assert_eq!(lines[2], "0.5,7,0.5,0,-1,0,,,,,,,");
}

#[test]
fn tables_without_places_are_refused_by_name_before_any_work() {
    let workshop = Workshop::with(&square());
    for (text, word) in [
        ("x,y,z\n1,2,3\n", "no column nx"),
        ("x,y,z,nx,ny,nz\n1,2,3,0,1,0\n1,2,three,0,1,0\n", "line 3 has `three` for z"),
        ("x,y,z,nx,ny,nz\n1,2,3,0,0,0\n", "line 2 has no normal"),
        ("x,y,z,nx,ny,nz\n1,2,3\n", "cannot be read"),
    ] {
        fs::write(workshop.path("points.csv"), text).unwrap();
        for more in [&[][..], &["--target-error", "5%"]] {
            let arguments = [&["scene.glb", "--points", "points.csv"], more].concat();
            let ended = workshop.run("assemble", &arguments);
            assert_eq!(ended.code, Some(1), "{}", ended.stdout);
            assert!(ended.stderr.contains("points.csv") && ended.stderr.contains(word), "{}", ended.stderr);
        }
    }
    assert!(!workshop.path("out").exists() && !workshop.path(".equilux").exists(), "files of a refused run");
}
