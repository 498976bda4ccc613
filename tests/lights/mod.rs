//! Punctual lights, suns and skies: closed forms, effects on the scene, and cost.

mod enclosed;
mod points;
mod skies;
mod spots;
mod units;

use equilux_assemble::gather::Gather;
use equilux_assemble::gather::faces::CoplanarFaces;
use equilux_assemble::gather::lights::Lights;
use equilux_assemble::gather::outside::lights;
use equilux_assemble::gather::sky::Sky;
use equilux_assemble::gather::surface_piece::SurfacePiece;
use equilux_bake::elements::ElementSize;
use equilux_bake::oven::prepare::{Division, Preparation, RowMethod};
use equilux_bake::treecode::EXACT;
use equilux_formats::{LightKind, LightUnits, Part, PunctualLight, Rgb};
use equilux_tests::lit::{Lit, lit};
use equilux_tests::model::{Model, Node};
use equilux_tests::shapes::{grey, joined, part, rectangle, room, solid};
use equilux_tests::table::Table;
use equilux_tests::workshop::{Workshop, assembled};
use glam::{DVec3, dvec3};
use std::f64::consts::PI;

fn light(kind: LightKind, position: DVec3, direction: DVec3, intensity: f64) -> PunctualLight {
    let direction = direction.normalize();
    let (name, intensity, units) = ("light".into(), [intensity; 3], LightUnits::Radiometric);
    PunctualLight { name, position, direction, intensity: Rgb(intensity), units, kind, angle: 0.0 }
}

/// The parts in their places, elements of `size` metres.
fn placed(parts: Vec<Part>, size: f64) -> Lit {
    let nodes: Vec<Node> =
        parts.into_iter().enumerate().map(|(k, p)| Node::new(&format!("{k}"), p)).collect();
    let workshop = Workshop::with(&nodes);
    let wanted = Preparation {
        element_size: Some(ElementSize::Metres(size)),
        division: Division::Authored,
        resolution: EXACT,
        rows: RowMethod::Exact,
        rays: 256,
        local_solver: None,
    };
    lit(&workshop.path("scene.glb"), &wanted)
}

/// Average direct irradiance of all elements, first channel.
fn direct(scene: &Lit, lights: &Lights) -> Vec<f64> {
    let world = &scene.placed.world;
    let dark: Vec<Rgb> = vec![Rgb::BLACK; world.elements.len()];
    let gather = Gather::new(&scene.placed, &dark, &dark, lights, EXACT);
    let planes: Vec<CoplanarFaces> = world.elements.iter().map(|e| gather.faces().plane_of(e.face)).collect();
    let pieces: Vec<SurfacePiece> = world
        .elements
        .iter()
        .zip(&planes)
        .map(|(e, plane)| SurfacePiece { corners: e.corners.as_slice(), normal: e.normal, plane })
        .collect();
    gather.direct(&pieces, Rgb::BLACK).iter().map(|h| h[0]).collect()
}

fn of_file(scene: &Lit, sources: &[PunctualLight]) -> Lights {
    lights(sources, None, None, &scene.placed.world)
}

/// Solid angle of the rectangle 0..a × 0..b at height h over its corner, sr.
fn corner(a: f64, b: f64, h: f64) -> f64 {
    (a * b / (h * (a * a + b * b + h * h).sqrt())).atan()
}

/// The solid angle of the rectangle x0..x1 × z0..z1 in y = 0 from a point of height h over the origin.
fn rectangle_angle([x0, x1]: [f64; 2], [z0, z1]: [f64; 2], h: f64) -> f64 {
    let f = |x: f64, z: f64| (x * z).signum() * corner(x.abs(), z.abs(), h);
    f(x1, z1) - f(x0, z1) - f(x1, z0) + f(x0, z0)
}

/// The floor −2..2 × −2..2, looking up.
fn floor() -> Part {
    rectangle(part(grey(0.0, 0.0)), dvec3(-2.0, 0.0, -2.0), 4.0 * DVec3::Z, 4.0 * DVec3::X)
}

#[test]
fn a_point_of_light_sends_every_element_its_solid_angle() {
    let scene = placed(vec![floor()], 0.5);
    let lamp = light(LightKind::Point, dvec3(0.0, 1.5, 0.0), DVec3::NEG_Y, 10.0);
    let found = direct(&scene, &of_file(&scene, &[lamp]));
    for (element, h) in scene.placed.world.elements.iter().zip(found) {
        let c = element.centroid;
        let expected = 10.0 * rectangle_angle([c.x - 0.25, c.x + 0.25], [c.z - 0.25, c.z + 0.25], 1.5) / 0.25;
        // Four arc tangents that nearly cancel.
        assert!((h - expected).abs() <= 1e-12 * expected.max(1.0), "{h} at {c}, expected {expected}");
    }
}

#[test]
fn a_shadow_of_a_point_of_light_ends_exactly() {
    // A square of a metre at half the height hides two metres of the floor: four elements, whose edges are the shadow's, and
    // a quarter of what is moved by half an element.
    for offset in [0.0, 0.125] {
        let screen = rectangle(part(grey(0.0, 0.0)), dvec3(-0.5 + offset, 1.0, -0.5), DVec3::Z, DVec3::X);
        let scene = placed(vec![floor(), screen], 1.0);
        let lamp = light(LightKind::Point, dvec3(0.0, 2.0, 0.0), DVec3::NEG_Y, 1.0);
        let found = direct(&scene, &of_file(&scene, &[lamp]));
        let shadow = ([-1.0 + 2.0 * offset, 1.0 + 2.0 * offset], [-1.0, 1.0]);
        for (element, h) in scene.placed.world.elements.iter().zip(found) {
            if element.centroid.y > 0.5 {
                continue;
            }
            let c = element.centroid;
            let (x, z) = ([c.x - 0.5, c.x + 0.5], [c.z - 0.5, c.z + 0.5]);
            let common = |a: [f64; 2], b: [f64; 2]| [a[0].max(b[0]), a[1].min(b[1])];
            let (sx, sz) = (common(x, shadow.0), common(z, shadow.1));
            let dark = if sx[0] < sx[1] && sz[0] < sz[1] { rectangle_angle(sx, sz, 2.0) } else { 0.0 };
            let expected = rectangle_angle(x, z, 2.0) - dark;
            assert!((h - expected).abs() <= 1e-12, "{h} at {c}, expected {expected}");
        }
    }
}

#[test]
fn a_spot_shines_in_its_cone_only_and_as_a_point_inside() {
    let scene = placed(vec![floor()], 0.25);
    let kind = LightKind::Spot { inner: 0.3, outer: 0.4 };
    let at = dvec3(0.0, 2.0, 0.0);
    let spot = direct(&scene, &of_file(&scene, &[light(kind, at, DVec3::NEG_Y, 5.0)]));
    let point = direct(&scene, &of_file(&scene, &[light(LightKind::Point, at, DVec3::NEG_Y, 5.0)]));
    let reach = |tangent: f64| 2.0 * tangent;
    let (mut inside, mut outside) = (0, 0);
    for (element, (spot, point)) in scene.placed.world.elements.iter().zip(spot.into_iter().zip(point)) {
        let radii = element.corners.as_slice().iter().map(|p| dvec3(p.x, 0.0, p.z).length());
        let (near, far) = radii.fold((f64::INFINITY, 0.0f64), |(n, f), r| (n.min(r), f.max(r)));
        if far <= reach(0.3f64.tan()) {
            assert!((spot - point).abs() <= 1e-12 * point, "{spot} inside the cone, a point sends {point}");
            inside += 1;
        } else if near - 0.25 * 2f64.sqrt() >= reach(0.4f64.tan()) {
            assert!(spot == 0.0, "{spot} outside of the cone");
            outside += 1;
        }
    }
    assert!(inside > 0 && outside > 0, "{inside} elements inside, {outside} outside");
}

/// The wall x = 0 with a window of 1 × 1 m from 1 m up, looking either way, and the floor before it.
fn window() -> Vec<Part> {
    let mut wall = part(grey(0.0, 0.0));
    for (y, z, height, width) in
        [(0.0, -3.0, 1.0, 6.0), (2.0, -3.0, 1.0, 6.0), (1.0, -3.0, 1.0, 2.5), (1.0, 0.5, 1.0, 2.5)]
    {
        wall = rectangle(wall, dvec3(0.0, y, z), height * DVec3::Y, width * DVec3::Z);
    }
    let floor = rectangle(part(grey(0.0, 0.0)), dvec3(0.0, 0.0, -2.0), 4.0 * DVec3::Z, 4.0 * DVec3::X);
    vec![joined([wall, floor])]
}

#[test]
fn sun_through_a_window_lights_its_exact_outline() {
    let scene = placed(window(), 0.3);
    // Two along for one down: the window's metre from 1 to 2 m lies from 2 to 4 m on the floor, shifted by a quarter of that.
    let direction = dvec3(2.0, -1.0, 0.25);
    let sun = light(LightKind::Directional, DVec3::ZERO, direction, 7.0);
    let found = direct(&scene, &of_file(&scene, &[sun]));
    let upright = 7.0 * direction.normalize().dot(DVec3::NEG_Y);
    let (mut lit, mut area) = (0.0, 0.0);
    for (element, h) in scene.placed.world.elements.iter().zip(found) {
        if element.normal.y < 0.5 {
            continue;
        }
        let share = h / upright;
        assert!((-1e-9..=1.0 + 1e-5).contains(&share), "{share} of the sun at {}", element.centroid);
        lit += share * element.area;
        let inside = element.corners.as_slice().iter().all(|p| {
            let back = p.x / 2.0;
            (1.0..=2.0).contains(&back) && (p.z - 0.25 * back).abs() <= 0.5
        });
        if inside {
            assert!((share - 1.0).abs() <= 1e-5, "{share} of the sun in the window's light");
        }
        area += element.area;
    }
    // Of 4 × 4 m the window's light covers 2 × 1: the sun's rays meet 10⁶ sizes of the scene away.
    assert!((lit - 2.0).abs() <= 2e-5, "{lit} m² of {area} are lit, expected 2");
}

#[test]
fn a_sun_with_a_width_lights_open_ground_as_parallel_rays_do() {
    let scene = placed(vec![floor()], 1.0);
    let direction = dvec3(1.0, -2.0, 0.5);
    let parallel = light(LightKind::Directional, DVec3::ZERO, direction, 3.0);
    let wide = PunctualLight { angle: 0.00925, ..parallel.clone() };
    let [sharp, soft] = [parallel, wide].map(|sun| direct(&scene, &of_file(&scene, &[sun])));
    for (sharp, soft) in sharp.into_iter().zip(soft) {
        // Its rays meet 10⁴ sizes of the scene away.
        assert!((sharp - soft).abs() <= 2e-4 * sharp, "{soft} from a disc, {sharp} from parallel rays");
    }
}

/// A box with black sides, open above.
fn half_open() -> Part {
    let mut open = room(grey(0.0, 0.0), DVec3::ZERO, dvec3(2.0, 1.0, 2.0));
    open.surfaces.retain(|s| s.corners.double_area_vector().y >= 0.0);
    open
}

#[test]
fn a_uniform_sky_lights_the_floor_of_an_open_box_through_its_opening() {
    let workshop = Workshop::with(&[Node::new("box", half_open())]);
    let mut job = workshop.job(Division::Authored);
    let table = workshop.path("elements.csv");
    job.settings.sky = Some(Sky::Uniform(Rgb([2.0; 3])));
    job.settings.preparation.element_size = Some(ElementSize::Metres(0.5));
    job.outputs.elements = Some(table.clone());
    let report = assembled(&job);
    assert!(report.form_factors_computed > 0, "the sky is seen");
    let found = Table::read(&table);
    // The fraction of the hemisphere that the rectangle of a × b over its corner at height c fills: (1/2π) [...].
    let over = |a: f64, b: f64, c: f64| {
        let (x, y) = (a / c, b / c);
        let (rx, ry) = ((1.0 + x * x).sqrt(), (1.0 + y * y).sqrt());
        (x / rx * (y / rx).atan() + y / ry * (x / ry).atan()) / (2.0 * PI)
    };
    let mut floors = 0;
    for row in 0..found.rows() {
        if found.number(row, "ny") < 0.5 {
            continue;
        }
        let [x, z] = ["x", "z"].map(|axis| found.number(row, axis));
        let seen: f64 = [(x, z), (2.0 - x, z), (x, 2.0 - z), (2.0 - x, 2.0 - z)]
            .iter()
            .map(|&(a, b)| over(a, b, 1.0))
            .sum();
        let (h, expected) = (found.number(row, "H_g"), 2.0 * PI * seen);
        // The table has about nine digits.
        assert!((h - expected).abs() <= 1e-7 * expected, "{h} at {x}, {z}, expected {expected}");
        floors += 1;
    }
    assert_eq!(floors, 16);

    let mut brighter = job;
    brighter.settings.sky = Some(Sky::Uniform(Rgb([4.0; 3])));
    let again = assembled(&brighter);
    assert_eq!(again.form_factors_computed, 0, "another sky");
    let ratio = Table::read(&table).number(0, "H_g") / found.number(0, "H_g");
    assert!((ratio - 2.0).abs() <= 1e-6, "twice the sky is {ratio} times the light");
}

#[test]
fn light_of_lamps_goes_to_and_fro_as_that_of_surfaces() {
    // In a closed white box, ρ = ½, all power of the lamp arrives, and as much again is reflected: Σ A H = Φ/(1 − ρ).
    let lamp = json_light();
    let model = Model::of(&[Node::new("box", room(grey(0.5, 0.0), DVec3::ZERO, DVec3::splat(2.0)))]);
    let workshop = Workshop::new();
    with_light(model, lamp).write(&workshop.path("scene.glb"));
    let mut job = workshop.job(Division::Authored);
    let table = workshop.path("elements.csv");
    job.settings.preparation.element_size = Some(ElementSize::Metres(0.25));
    job.outputs.elements = Some(table.clone());
    job.outputs.verify = true;
    let report = assembled(&job);
    let found = Table::read(&table);
    let arriving: f64 =
        (0..found.rows()).map(|row| found.number(row, "area") * found.number(row, "H_r")).sum();
    let expected = 2.0 * 4.0 * PI * 3.0;
    // Direct light is exact; of reflected light collocation keeps the power only on average.
    assert!((arriving / expected - 1.0).abs() <= 5e-3, "{arriving} W arrive, expected {expected}");
    let off = report.verify.expect("asked for").max_rel_diff;
    assert!(off <= 1e-9, "{off} away from the classic matrix");
}

/// A point of 3 W/sr in the middle of a box of 2 m.
fn json_light() -> serde_json::Value {
    serde_json::json!({ "type": "point", "intensity": 3.0, "color": [1.0, 1.0, 1.0] })
}

fn with_light(mut model: Model, light: serde_json::Value) -> Model {
    let nodes = model.json["nodes"].as_array_mut().expect("nodes");
    nodes.push(serde_json::json!({
        "name": "lamp", "translation": [1.0, 1.0, 1.0], "extensions": { "KHR_lights_punctual": { "light": 0 } },
    }));
    let last = nodes.len() - 1;
    model.json["scenes"][0]["nodes"].as_array_mut().expect("roots").push(last.into());
    model.json["extensions"] = serde_json::json!({ "KHR_lights_punctual": { "lights": [light] } });
    model.json["extensionsUsed"].as_array_mut().expect("extensions").push("KHR_lights_punctual".into());
    model
}

#[test]
fn a_texel_under_a_crate_is_dark_and_one_beside_it_is_not() {
    let walls = room(grey(0.5, 0.0), DVec3::ZERO, dvec3(4.0, 3.0, 4.0));
    let lamp = rectangle(part(grey(0.0, 10.0)), dvec3(1.5, 2.5, 1.5), DVec3::X, DVec3::Z);
    let wooden = solid(grey(0.5, 0.0), dvec3(1.0, 0.0, 1.0), dvec3(1.5, 0.5, 1.5));
    let scene = placed(vec![walls, lamp, wooden], 0.5);
    let (emission, radiosity) = (&scene.optics.emission, &scene.outcome.radiosity);
    let gather = Gather::new(&scene.placed, emission, radiosity, &Lights::default(), EXACT);
    let plane = gather.faces().in_plane(DVec3::ZERO, DVec3::Y);
    let light = |x: f64, z: f64, size: f64| -> f64 {
        let corners = [
            dvec3(x, 0.0, z),
            dvec3(x, 0.0, z + size),
            dvec3(x + size, 0.0, z + size),
            dvec3(x + size, 0.0, z),
        ];
        let pieces = [SurfacePiece { corners: &corners, normal: DVec3::Y, plane: &plane }];
        gather.direct(&pieces, Rgb([1.0; 3]))[0][0] + gather.reflected_over(&pieces, Rgb([1.0; 3]))[0][0]
    };
    for (x, z) in [(1.0, 1.0), (1.2, 1.3), (1.45, 1.45)] {
        assert_eq!(light(x, z, 0.05), 0.0, "under the crate at {x}, {z}");
    }
    let beside = light(1.55, 1.55, 0.05);
    assert!(beside > 0.0, "{beside} beside the crate");
    // Half of it lies under the crate.
    let half = light(1.475, 1.2, 0.05);
    assert!(half > 0.0 && half < light(1.51, 1.2, 0.05), "{half} on the crate's edge");
}
