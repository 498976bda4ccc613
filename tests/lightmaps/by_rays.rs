//! Lightmaps of scenes whose rows are counted rays.

use equilux_assemble::SolveSettings;
use equilux_assemble::equation::environment::Environment;
use equilux_assemble::exchange::listener::Unobserved;
use equilux_assemble::gather::receiver::receiver;
use equilux_assemble::lightmap::atlas::Atlas;
use equilux_assemble::lightmap::by_rays::irradiance;
use equilux_assemble::lightmap::texels::Texels;
use equilux_assemble::receivers::Receivers;
use equilux_assemble::solve::{Solved, solve_prepared};
use equilux_bake::elements::ElementSize;
use equilux_bake::monitor::Monitor;
use equilux_bake::oven::prepare::{RowMethod, prepare};
use equilux_formats::{Element, FaceId, LightKind, LightUnits, PunctualLight, Rgb, Scene, Store};
use equilux_tests::shapes::{grey, part, rectangle, room, scene_of, solid};
use glam::{DVec3, dvec3};
use std::path::Path;

/// The light of a scene by 256 rays a row, with elements of 0.3 m.
fn solved(scene: &Scene, cache: &Path) -> (Solved, Store) {
    let mut settings = SolveSettings { cache: cache.into(), ..SolveSettings::default() };
    settings.preparation.element_size = Some(ElementSize::Metres(0.3));
    (settings.preparation.rows, settings.preparation.rays) = (RowMethod::Rays, 256);
    let prepared = prepare(scene, &settings.preparation).expect("elements");
    let store = Store::open(cache).expect("a cache");
    let environment = Environment::read(None, None).expect("no sky");
    let monitor = Monitor::default();
    let solved = solve_prepared(scene, prepared, &environment, &settings, &store, &monitor, &Unobserved);
    (solved.expect("light"), store)
}

/// The light of all texels of 0.1 m, by tile.
fn texels(scene: &Scene, cache: &Path) -> (Atlas, Vec<Vec<Option<Rgb>>>) {
    texels_of(scene, cache, 0.1)
}

/// The light of all texels of this size, by tile.
pub fn texels_of(scene: &Scene, cache: &Path, size: f64) -> (Atlas, Vec<Vec<Option<Rgb>>>) {
    let (solved, store) = solved(scene, cache);
    let monitor = Monitor::default();
    let receivers = Receivers::new(scene, &solved, &store, 256, &monitor).expect("rows by rays");
    let atlas = Atlas::new(scene, Some(size)).expect("an atlas");
    let light = irradiance(&receivers, &atlas).expect("not stopped");
    (atlas, light)
}

/// A room of 3 × 2 × 3 m with a crate on the floor.
fn furnished(reflectance: f64, emission: f64) -> Scene {
    let crate_ = solid(grey(reflectance, emission), dvec3(1.6, 0.0, 1.9), dvec3(2.23, 0.5, 2.41));
    scene_of(vec![room(grey(reflectance, emission), DVec3::ZERO, dvec3(3.0, 2.0, 3.0)), crate_])
}

/// The same with a lamp of this emission under the ceiling.
fn lit(emission: f64) -> Scene {
    let mut parts = furnished(0.5, 0.0).parts;
    parts.push(solid(grey(0.2, emission), dvec3(1.2, 1.7, 1.2), dvec3(1.5, 1.8, 1.6)));
    scene_of(parts)
}

/// Every ray ends on a surface that sends E/(1 − ρ), also beside and under the crate; rows are whole numbers, and interpolation
/// between equal numbers keeps them.
#[test]
fn texels_of_a_furnace_have_one_irradiance() {
    let folder = tempfile::tempdir().expect("a folder");
    let (atlas, light) = texels(&furnished(0.75, 1.0), folder.path());
    // The bottom of the crate lies in the floor and looks out of the room.
    let is_bottom = |instance: usize, direction: DVec3| instance == 1 && direction.y < -0.5;
    let tiles = atlas.tiles();
    let seen = tiles
        .iter()
        .zip(&light)
        .filter(|(tile, _)| !is_bottom(tile.instance, atlas.chart_of(tile).0.direction));
    let seen = seen.flat_map(|(_, light)| light.iter().flatten());
    let worst = seen.map(|h| (h[0] - 4.0).abs()).fold(0.0, f64::max);
    // The exchange is proved to a millionth of the brightest; the difference of two floats of the sharp light's f32 rows adds less.
    assert!(worst <= 1e-5, "{worst} off 4 W/m²");
}

/// What lamps send is in no block, and how charts are divided follows from geometry: what is kept serves any power.
#[test]
fn a_dimmed_lamp_needs_no_rays_and_gives_what_a_run_from_nothing_gives() {
    let [kept, fresh] = [(); 2].map(|()| tempfile::tempdir().expect("a folder"));
    let (_, bright) = texels(&lit(2.0), kept.path());
    let before = std::fs::read_dir(kept.path()).expect("a folder").count();
    let (_, dimmed) = texels(&lit(0.5), kept.path());
    let (_, from_nothing) = texels(&lit(0.5), fresh.path());
    assert!(dimmed == from_nothing, "the cache changed the light");
    assert!(bright != dimmed, "the lamp was dimmed");
    let after = std::fs::read_dir(kept.path()).expect("a folder").count();
    // Only light of parts, which holds what they send, is new: at most one file for each part.
    assert!(after <= before + 3, "{before} files, then {after}");
}

/// Texels in the open against exact direct light and 4096 rays at their middles. A texel of 0.1 m averages over a hundredth of a
/// square metre, and its rays have the noise of 256: 2 % of the mean, as the root mean square over the floor.
#[test]
fn texels_agree_with_light_at_points() {
    let folder = tempfile::tempdir().expect("a folder");
    let scene = lit(2.0);
    let (atlas, light) = texels(&scene, folder.path());
    let (solved, _) = solved(&scene, folder.path());
    let gather = solved.gather();
    let (mut points, mut found): (Vec<Element>, Vec<f64>) = (vec![], vec![]);
    for (tile, light) in atlas.tiles().iter().zip(&light).filter(|(tile, _)| tile.instance == 0) {
        let (chart, grid) = atlas.chart_of(tile);
        let texels = Texels::new(chart, grid, 0..tile.size[1], 0, scene.instances[0].placement);
        for texel in texels.texels.iter().step_by(7) {
            let patch = texels.patches[texel.footprints[0].patch];
            let middle = patch.point(glam::dvec2(f64::from(texel.at[0]) + 0.5, f64::from(texel.at[1]) + 0.5));
            // Where shadows end a texel has the mean of both sides, and next to a wall half of it is beyond.
            let inside = (middle - dvec3(1.5, 1.0, 1.5)).abs();
            let is_open =
                patch.normal.y < -0.5 && inside.x < 1.3 && inside.z < 1.3 && inside.x.hypot(inside.z) > 0.6;
            let value = light[(texel.at[1] * tile.size[0] + texel.at[0]) as usize];
            if let (true, Some(value)) = (is_open, value) {
                let faces = gather.faces().in_plane(middle, patch.normal);
                let face = faces.face_at(middle).unwrap_or(FaceId(0));
                points.push(receiver(middle, patch.normal, face));
                found.push(value[1]);
            }
        }
    }
    assert!(points.len() > 50, "{} points", points.len());
    let expected: Vec<f64> = gather.irradiance(&points).iter().map(|h| h[1]).collect();
    let mean = expected.iter().sum::<f64>() / expected.len() as f64;
    let square =
        found.iter().zip(&expected).map(|(a, b)| (a - b).powi(2)).sum::<f64>() / expected.len() as f64;
    assert!(square.sqrt() <= 0.02 * mean, "{} RMS of a mean of {mean}", square.sqrt());
}

/// A lamp lights a strip of floor 10 cm wide before a low black wall; elements are wider. A point at height h of the wall gets
/// ρ H (1 − h/√(h² + d²))/2 from a strip of depth d, whatever the mean of the elements in it.
#[test]
fn a_point_on_a_wall_sees_where_the_lit_strip_before_it_ends() {
    let (depth, height, reflectance) = (0.1, 0.03, 0.5);
    let floor =
        rectangle(part(grey(reflectance, 0.0)), dvec3(-2.0, 0.0, -2.0), 4.0 * DVec3::Z, 4.0 * DVec3::X);
    let wall = rectangle(part(grey(0.0, 0.0)), dvec3(0.0, 0.0, -2.0), 0.2 * DVec3::Y, 4.0 * DVec3::Z);
    let sheet = rectangle(part(grey(0.0, 0.0)), dvec3(depth, 2.0, -3.0), 6.0 * DVec3::Z, 3.0 * DVec3::X);
    let mut scene = scene_of(vec![floor, wall, sheet]);
    let intensity = 16.0;
    scene.lights.push(PunctualLight {
        name: "lamp".into(),
        position: dvec3(depth, 4.0, 0.0),
        direction: DVec3::NEG_Y,
        intensity: Rgb::splat(intensity),
        units: LightUnits::Radiometric,
        kind: LightKind::Point,
        angle: 0.0,
    });
    let folder = tempfile::tempdir().expect("a folder");
    let (solved, store) = solved(&scene, folder.path());
    let monitor = Monitor::default();
    let receivers = Receivers::new(&scene, &solved, &store, 256, &monitor).expect("rows by rays");
    let found = receivers.reflected_at(&[receiver(dvec3(0.0, height, 0.0), DVec3::X, FaceId(0))])[0][0];
    let irradiance = intensity / 16.0;
    let expected = reflectance * irradiance * (1.0 - height / height.hypot(depth)) / 2.0;
    // Far parts of the strip get 2 % less; the edge of the shadow lies within cells of 1 cm; 4096 rays leave half a percent.
    assert!((found / expected - 1.0).abs() <= 0.05, "{found} W/m² instead of {expected}");
}
