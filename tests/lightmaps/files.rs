//! The files that `--lightmaps` writes.

use equilux_assemble::lightmap::{LightmapOptions, Units};
use equilux_assemble::outputs::requests::Pictures;
use equilux_bake::oven::prepare::Division;
use equilux_tests::curved::sphere;
use equilux_tests::model::{Model, Node};
use equilux_tests::rooms::{furnished, square};
use equilux_tests::shapes::{grey, joined, part, rectangle, room, triangle};
use equilux_tests::workshop::{Workshop, assembled};
use exr::prelude::read_first_rgba_layer_from_file;
use glam::{DVec3, dvec3};
use serde_json::{Value, json};
use std::f64::consts::PI;
use std::path::Path;

const FILES: [&str; 5] =
    ["lightmap.exr", "lightmap.png", "lightmapped.glb", "lightmapped.unlit.glb", "lightmaps.json"];

/// All texels of an EXR file, row after row, and its width.
pub fn texels(path: &Path) -> (usize, Vec<[f32; 3]>) {
    let picture = read_first_rgba_layer_from_file(
        path,
        |size, _| (size.width(), vec![[0.0; 3]; size.area()]),
        |(width, texels): &mut (usize, Vec<[f32; 3]>), at, (r, g, b, _): (f32, f32, f32, f32)| {
            texels[at.y() * *width + at.x()] = [r, g, b];
        },
    );
    picture.unwrap_or_else(|error| panic!("{}: {error}", path.display())).layer_data.channel_data.pixels
}

/// Writes lightmaps of `nodes` with texels of 5 cm.
pub fn baked(nodes: &[Node], units: Units) -> Workshop {
    divided(nodes, units, Division::Authored)
}

/// The same with other parts for the exchange. Lightmaps are of the scene's own parts all the same.
fn divided(nodes: &[Node], units: Units, division: Division) -> Workshop {
    let workshop = Workshop::with(nodes);
    let mut job = workshop.job(division);
    job.outputs.lightmaps =
        Some(LightmapOptions { texel_size: Some(0.05), units, ..LightmapOptions::default() });
    job.outputs.pictures = Pictures::None;
    assembled(&job);
    workshop
}

/// In a closed room where all emit 1 W/m² and reflect half, irradiance is 2 W/m² everywhere, also around a ball whose charts
/// meet at seams.
#[test]
fn a_furnace_has_an_even_lightmap() {
    let ball = sphere(0.3, 1)
        .into_iter()
        .map(|corners| corners.map(|p| p + DVec3::ONE))
        .fold(part(grey(0.5, 1.0)), triangle);
    let furnace = joined([room(grey(0.5, 1.0), DVec3::ZERO, dvec3(2.0, 2.0, 3.0)), ball]);
    for (units, division, expected) in
        [(Units::Irradiance, Division::Authored, 2.0), (Units::Bevy, Division::Bisect(3), 2.0 / PI)]
    {
        let workshop = divided(&[Node::new("furnace", furnace.clone())], units, division);
        let (_, texels) = texels(&workshop.path("out/scene/lightmap.exr"));
        let lit: Vec<f32> = texels.into_flattened().into_iter().filter(|&h| h != 0.0).collect();
        // Half floats have eleven bits.
        let worst = lit.iter().map(|&h| (f64::from(h) / expected - 1.0).abs()).fold(0.0, f64::max);
        assert!(
            worst <= 2f64.powi(-11),
            "{units:?} is off by {worst} of {expected}, half floats by {}",
            2f64.powi(-11)
        );
        // 32 m² of walls in texels of 25 cm², three times.
        assert!(lit.len() > 3 * 12_800, "{} numbers", lit.len());
    }
}

#[test]
fn files_are_the_same_bytes_for_any_number_of_threads() {
    let workshop = Workshop::with(&furnished());
    let made = |threads: &str| {
        let ended = workshop.run(
            "assemble",
            &[
                "scene.glb",
                "--element-size",
                "0.5",
                "--lightmaps",
                "--texel-size",
                "0.05",
                "--threads",
                threads,
            ],
        );
        assert_eq!(ended.code, Some(0), "{}", ended.stderr);
        let files = FILES.map(|name| std::fs::read(workshop.path("out/scene").join(name)).expect(name));
        std::fs::remove_dir_all(workshop.path("out")).expect("a folder to remove");
        files
    };
    for ((name, one), two) in FILES.iter().zip(made("1")).zip(made("2")) {
        assert!(one == two, "{name}: {} bytes with one thread, other {} with two", one.len(), two.len());
    }
}

#[test]
fn the_list_names_images_by_their_contents_and_a_place_for_each_node() {
    let workshop = baked(&furnished(), Units::Irradiance);
    let read = |name: &str| std::fs::read(workshop.path("out/scene").join(name)).expect(name);
    let list: Value = serde_json::from_slice(&read("lightmaps.json")).expect("JSON");
    let image = &list["images"][0];
    assert_eq!(image["blake3"], json!(blake3::hash(&read("lightmap.exr")).to_hex().as_str()));
    assert_eq!(image["preview_blake3"], json!(blake3::hash(&read("lightmap.png")).to_hex().as_str()));
    assert_eq!(list["texel_size"], json!(0.05));
    let names: Vec<&str> =
        list["nodes"].as_array().expect("nodes").iter().filter_map(|n| n["name"].as_str()).collect();
    assert_eq!(names, ["crate", "light", "table", "walls"]);
    for node in list["nodes"].as_array().expect("nodes") {
        let [offset, scale] = ["offset", "scale"]
            .map(|key| [0, 1].map(|i: usize| node["rectangles"][0][key][i].as_f64().expect("a number")));
        assert!((0..2).all(|i| offset[i] >= 0.0 && offset[i] + scale[i] <= 1.0), "{node}");
    }
}

/// Half floats end at 65504 and lose digits below 6e-5: brighter and darker light is scaled, and the list contains the scale.
#[test]
fn light_that_half_floats_cannot_hold_is_scaled_and_said_so() {
    for strength in [1e9, 1.0, 1e-9] {
        let workshop = Workshop::new();
        Model::of(&furnished())
            .with(
                "/materials/5/extensions",
                json!({
                    "KHR_materials_emissive_strength": { "emissiveStrength": strength },
                }),
            )
            .write(&workshop.path("scene.glb"));
        let lit = workshop
            .run("assemble", &["scene.glb", "--element-size", "1", "--lightmaps", "--texel-size", "0.2"]);
        let folder = workshop.path("out/scene");
        let list = std::fs::read(folder.join("lightmaps.json")).unwrap_or_else(|_| panic!("{}", lit.stderr));
        let scale =
            serde_json::from_slice::<Value>(&list).expect("JSON")["scale"].as_f64().expect("a number");
        let most = texels(&folder.join("lightmap.exr")).1.into_flattened().into_iter().fold(0.0, f32::max);
        assert!(most.is_finite() && most > 0.05, "strength {strength}: the brightest number is {most}");
        assert_eq!(scale != 1.0, strength != 1.0, "strength {strength} is scaled by {scale}");
        assert_eq!(lit.stdout.contains("half floats"), scale != 1.0, "{}", lit.stdout);
    }
}

#[test]
fn a_texel_size_that_nothing_can_hold_is_an_input_error_before_any_work() {
    let workshop = Workshop::with(&square());
    for (size, code) in [("1e-9", 1), ("0", 2), ("-1", 2), ("NaN", 2)] {
        let ended = workshop.run("assemble", &["scene.glb", "--lightmaps", &format!("--texel-size={size}")]);
        assert_eq!(ended.code, Some(code), "texels of {size}: {}", ended.stderr);
        assert!(ended.stderr.contains("texel"), "{}", ended.stderr);
    }
    assert!(!workshop.path(".equilux").exists(), "nothing is baked before the lightmap is known to fit");
}

/// In a black room with one small lamp all light comes straight from it; beside a lamp that fills a wall it does not.
#[test]
fn directions_point_to_where_light_comes_from() {
    let black = room(grey(0.0, 0.0), DVec3::ZERO, dvec3(2.0, 2.0, 2.0));
    let low = dvec3(0.99, 1.98, 0.99);
    let lamp = rectangle(part(grey(0.0, 1000.0)), low, 0.02 * DVec3::X, 0.02 * DVec3::Z);
    let workshop = Workshop::with(&[Node::new("room", black), Node::new("lamp", lamp)]);
    let mut job = workshop.job(Division::Authored);
    job.outputs.lightmaps =
        Some(LightmapOptions { texel_size: Some(0.1), directions: true, ..LightmapOptions::default() });
    job.outputs.pictures = Pictures::None;
    assembled(&job);
    let list = std::fs::read(workshop.path("out/scene/lightmaps.json")).expect("a list");
    let list: Value = serde_json::from_slice(&list).expect("JSON");
    let name = list["images"][0]["direction"].as_str().expect("a file");
    let (_, light) = texels(&workshop.path("out/scene/lightmap.exr"));
    let (_, directions) = texels(&workshop.path("out/scene").join(name));
    let mut seen = 0;
    for (light, direction) in light.iter().zip(&directions).filter(|(light, _)| light[0] > 0.5) {
        let length = direction.iter().map(|d| d * d).sum::<f32>().sqrt();
        // Between gathered texels a direction may be off by 0.01 along each axis; margins hold the mean of neighbours, and on
        // the walls the lamp's direction turns by up to 0.1 a texel.
        assert!(
            (length - 1.0).abs() <= 0.02,
            "{length} long where {light:?} comes from one lamp: {direction:?}"
        );
        seen += 1;
    }
    assert!(seen > 100, "{seen} texels are lit");
    assert!(directions.iter().any(|d| d[1] > 0.99), "the floor below the lamp looks straight up");

    job.outputs.lightmaps =
        Some(LightmapOptions { directions: false, ..job.outputs.lightmaps.expect("asked for") });
    assembled(&job);
    assert!(!workshop.path("out/scene").join(name).exists(), "directions of an earlier run are gone");
}
