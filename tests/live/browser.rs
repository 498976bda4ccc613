//! The live page in a browser. Without Node.js or a browser, these tests print a message and pass.

use super::viewers::endless;
use base64::Engine;
use equilux_assemble::picture::camera::View;
use equilux_assemble::picture::canvas::Canvas;
use equilux_assemble::picture::exposure::Exposure;
use equilux_bake::elements::ElementSize;
use equilux_bake::gltf_import::import_scene;
use equilux_bake::oven::prepare::{Division, Preparation, RowMethod, prepare};
use equilux_bake::rays::RayIndex;
use equilux_bake::treecode::EXACT;
use equilux_bake::world::World;
use equilux_formats::{Element, Rgb};
use equilux_tests::rooms::echoing;
use equilux_tests::script::script;
use equilux_tests::workshop::Workshop;
use glam::{DVec2, dvec2};
use image::RgbImage;
use serde_json::{Value, json};
use std::f64::consts::PI;

/// Rows and columns of sampled points.
const POINTS: (usize, usize) = (40, 32);

/// The elements of the scene that the program is given.
fn world(workshop: &Workshop) -> World {
    let scene = import_scene(&workshop.path("scene.glb")).expect("the scene");
    let preparation = Preparation {
        element_size: Some(ElementSize::Metres(0.125)),
        division: Division::Authored,
        resolution: EXACT,
        rows: RowMethod::Exact,
        rays: 256,
        local_solver: None,
    };
    let prepared = prepare(&scene, &preparation).expect("elements");
    World::new(prepared.instances.iter().map(|i| (&prepared.parts[i.part.index()].geometry, i.placement)))
}

/// The view of a canvas that is narrower than the pictures: all that is in the pictures is in it.
fn view_on(canvas: DVec2, pictures: &View) -> View {
    let aspect = f64::from(pictures.width) / f64::from(pictures.height);
    let slope = (pictures.vertical_fov / 2.0).tan() * (aspect / (canvas.x / canvas.y)).max(1.0);
    View {
        width: canvas.x as u32,
        height: canvas.y as u32,
        vertical_fov: 2.0 * slope.atan(),
        ..pictures.clone()
    }
}

/// Pixels of a grid around which nothing but one element is seen, and that element.
fn points(view: &View, elements: &[Element]) -> Vec<((u32, u32), usize)> {
    let index = RayIndex::new(elements);
    let meets = |point: DVec2| Some(index.first_front(view.position, view.ray(point))?.element);
    let pixel = |i: usize| {
        let (x, y) = (i % POINTS.0, i / POINTS.0);
        let step =
            dvec2(f64::from(view.width), f64::from(view.height)) / dvec2(POINTS.0 as f64, POINTS.1 as f64);
        (step * dvec2(x as f64 + 0.5, y as f64 + 0.5)).floor()
    };
    let alone = |at: DVec2| {
        let around =
            [(-2.0, -2.0), (3.0, -2.0), (-2.0, 3.0), (3.0, 3.0)].map(|(x, y)| meets(at + dvec2(x, y)));
        let element = around[0]?;
        around.iter().all(|&e| e == Some(element)).then_some(((at.x as u32, at.y as u32), element))
    };
    (0..POINTS.0 * POINTS.1).filter_map(|i| alone(pixel(i))).collect()
}

fn picture(shot: &Value) -> RgbImage {
    let png = base64::engine::general_purpose::STANDARD.decode(shot.as_str().expect("a picture"));
    image::load_from_memory(&png.expect("base64")).expect("a PNG").to_rgb8()
}

/// Linear light as a byte of sRGB, IEC 61966-2-1.
fn srgb(light: f64) -> f64 {
    255.0 * if light <= 0.0031308 { 12.92 * light } else { 1.055 * light.powf(1.0 / 2.4) - 0.055 }
}

/// Radiosity and emission of all elements, W/m², as the program wrote them.
fn table(workshop: &Workshop) -> [Vec<Rgb>; 2] {
    let text = std::fs::read_to_string(workshop.path("table.csv")).expect("the table");
    let row = |line: &str| -> Vec<f64> {
        line.split(',').take(19).map(|number| number.parse().expect("a number")).collect()
    };
    let rows: Vec<Vec<f64>> = text.lines().skip(1).map(row).collect();
    [16, 10].map(|first| rows.iter().map(|row| Rgb([row[first], row[first + 1], row[first + 2]])).collect())
}

/// How far a picture is from the one of this light, mean over all points and channels, in steps of 255.
fn distance(shot: &Value, points: &[((u32, u32), usize)], radiosity: &[Rgb], exposure: f64) -> f64 {
    let (image, seen) = (picture(&shot["picture"]), shot["exposure"].as_f64().expect("a number"));
    let off = |&((x, y), element): &((u32, u32), usize)| -> f64 {
        let expected = Exposure(exposure).shown(radiosity[element]).map(srgb);
        let found = image.get_pixel(x, y).0.map(f64::from);
        // What would have been shown with the exposure of the end.
        let found = found.map(|byte| srgb((exposure / seen * unshown(byte)).min(1.0)));
        (0..3).map(|c| (found[c] - expected[c]).abs()).sum::<f64>() / 3.0
    };
    points.iter().map(off).sum::<f64>() / points.len() as f64
}

/// k·B/π of a byte of sRGB, as far as the tone curve tells.
fn unshown(byte: f64) -> f64 {
    let encoded = byte / 255.0;
    let light = if encoded <= 0.04045 { encoded / 12.92 } else { ((encoded + 0.055) / 1.055).powf(2.4) };
    if light <= 0.8 { light } else { 0.8 - 0.2 * ((1.0 - light).max(1e-3) / 0.2).ln() }
}

#[test]
fn the_page_shows_the_light_as_it_grows_and_stops_it() {
    let workshop = Workshop::with(&echoing(1e-4));
    let page = endless(&workshop, &["--elements", "table.csv", "--pictures", "last"]);
    let Some(found) = script("live.js", &json!({ "url": page.url })) else { return };
    assert_eq!(found["outside"], json!([]), "requests to anywhere else");
    assert_eq!(found["problems"], json!([]), "complaints of the browser");
    let phase = found["phase"].as_str().expect("a text");
    assert!(phase.contains("ended before"), "the page says '{phase}'");

    let (world, [radiosity, emission]) = (world(&workshop), table(&workshop));
    let shots = found["shots"].as_array().expect("shots");
    let canvas =
        dvec2(shots[0]["width"].as_f64().expect("a width"), shots[0]["height"].as_f64().expect("a height"));
    let pictures = View::of_scene(&[], &world.elements, &RayIndex::new(&world.elements));
    let view = view_on(canvas, &pictures);
    let points = points(&view, &world.elements);
    assert!(points.len() > 100, "{} points", points.len());

    // The exposure is that of the pictures, but for the number of rays that ask what is seen: it changes with the light of one
    // element to the next at the 95 % that stay below it.
    let exposure = shots[2]["exposure"].as_f64().expect("a number");
    let index = RayIndex::new(&world.elements);
    let canvas = Canvas::trace(pictures, &index);
    let chosen = Exposure::choose(|| canvas.elements(), &radiosity, &emission).0;
    assert!((exposure / chosen - 1.0).abs() < 0.05, "exposure {exposure}, that of the pictures is {chosen}");

    let last = picture(&shots[2]["picture"]);
    for &((x, y), element) in &points {
        let expected = Exposure(exposure).shown(radiosity[element]).map(srgb);
        let found = last.get_pixel(x, y).0.map(f64::from);
        for channel in 0..3 {
            // Half a step of rounding, and one for a graphics card's f32 powers.
            let off = (found[channel] - expected[channel]).abs();
            assert!(off <= 1.5, "({x}, {y}), element {element}: {found:?}, expected {expected:?}");
        }
    }

    let rounds: Vec<u64> = shots.iter().map(|shot| shot["round"].as_u64().expect("a round")).collect();
    assert!(rounds.is_sorted() && rounds[1] > rounds[0], "rounds {rounds:?}");
    let off: Vec<f64> = shots.iter().map(|shot| distance(shot, &points, &radiosity, exposure)).collect();
    assert!(off[0] > off[1] && off[1] > off[2], "rounds {rounds:?} are {off:?} of 255 from the end");
    let k = exposure / PI;
    assert!(radiosity.iter().flatten().any(|b| k * b > 0.1), "nothing to be seen");

    views_differ(&found["views"]);
}

/// Every view differs, and shows more than one colour.
fn views_differ(views: &Value) {
    let views: Vec<(&String, RgbImage)> =
        views.as_object().expect("views").iter().map(|(name, shot)| (name, picture(shot))).collect();
    for (i, (name, image)) in views.iter().enumerate() {
        let first = image.get_pixel(0, 0);
        assert!(image.pixels().any(|pixel| pixel != first), "{name} shows nothing");
        for (other, second) in &views[..i] {
            assert!(image != second, "{name} and {other} show the same");
        }
    }
}
