//! Our models in other programs: the Khronos validator, and three.js in a headless browser. Both run under Node.js,
//! from `tests/viewer`; if they are not installed, these tests print a message and pass.

use super::files::{baked, texels};
use equilux_assemble::lightmap::Units;
use equilux_assemble::lightmap::atlas::Atlas;
use equilux_assemble::lightmap::texels::bilinear;
use equilux_bake::gltf_import::import_scene;
use equilux_formats::Scene;
use equilux_tests::model::Node;
use equilux_tests::rooms::furnished;
use equilux_tests::script::script;
use equilux_tests::workshop::Workshop;
use glam::DVec3;
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::f64::consts::PI;
use std::path::PathBuf;

/// Furnished, with a second crate that shares the first one's mesh.
fn nodes() -> Vec<Node> {
    let mut nodes = furnished();
    let mut second = nodes[3].clone();
    (second.name, second.at) = ("second crate".into(), DVec3::new(2.5, 0.0, 0.5));
    nodes.push(second);
    nodes
}

fn models(workshop: &Workshop) -> [PathBuf; 3] {
    ["lightmapped.glb", "lightmapped.unlit.glb", "result.glb"]
        .map(|name| workshop.path("out/scene").join(name))
}

#[test]
fn the_khronos_validator_finds_neither_errors_nor_warnings() {
    let workshop = baked(&nodes(), Units::Irradiance);
    let Some(found) = script("validate.js", &json!({ "files": models(&workshop) })) else { return };
    assert_eq!(found["messages"], json!([]));
    assert_eq!(found["files"], json!(3), "files that were looked at");
}

/// A point of a surface, what is seen of it, W/(m²·sr), and how bright its material gets in its place.
struct Sight {
    point: DVec3,
    normal: DVec3,
    radiance: [f64; 3],
    peak: f64,
}

/// Points on all charts, and what the EXR file holds for them.
fn sights(workshop: &Workshop) -> Vec<Sight> {
    let scene: Scene = import_scene(&workshop.path("scene.glb")).expect("the scene");
    let atlas = Atlas::new(&scene, Some(0.05)).expect("the atlas");
    let (width, image) = texels(&workshop.path("out/scene/lightmap.exr"));
    let (mut sights, mut peaks) = (Vec::new(), BTreeMap::new());
    for tile in atlas.tiles() {
        let (chart, grid) = atlas.chart_of(&tile);
        let instance = &scene.instances[tile.instance];
        let material =
            &instance.materials(&scene.parts[instance.part.index()].materials)[chart.material.index()];
        let own = |i: usize| {
            let [x, y] = [i % tile.size[0] as usize, i / tile.size[0] as usize];
            image[(tile.spot.at[1] as usize + y) * width + tile.spot.at[0] as usize + x]
        };
        let seen =
            |h: [f64; 3]| [0, 1, 2].map(|c| (material.emission[c] + material.reflectance[c] * h[c]) / PI);
        let point = chart.sides[0].corners.centroid();
        let weights = bilinear(grid.texel_of(chart.planes[0], point), tile.size[0]);
        let h = [0, 1, 2].map(|c: usize| weights.iter().map(|&(i, w)| w * f64::from(own(i)[c])).sum());
        let all = (0..(tile.size[0] * tile.size[1]) as usize).map(|i| seen(own(i).map(f64::from)));
        let key = (tile.instance, chart.material);
        let peak: &mut f64 = peaks.entry(key).or_default();
        *peak = all.flatten().fold(*peak, f64::max);
        let sight = Sight {
            point: instance.placement.transform_point3(point),
            normal: instance.placement.transform_vector3(chart.direction).normalize(),
            radiance: seen(h),
            peak: 0.0,
        };
        sights.push((key, sight));
    }
    sights.into_iter().map(|(key, sight)| Sight { peak: peaks[&key], ..sight }).collect()
}

/// The emissive texture has eight bits in sRGB, whose steps near white are 0.9 % of the material's peak, so half of that
/// off; a graphics card mixes texels in steps of 1/256.
#[test]
fn three_js_shows_the_radiance_that_was_computed() {
    let workshop = baked(&nodes(), Units::Irradiance);
    let sights = sights(&workshop);
    let points: Vec<Value> = sights
        .iter()
        .map(|sight| json!({ "point": sight.point.to_array(), "normal": sight.normal.to_array() }))
        .collect();
    let input = json!({ "file": models(&workshop)[0], "points": points });
    let Some(answer) = script("view.js", &input) else { return };
    assert_eq!(answer["outside"], json!([]), "requests to anywhere else");
    assert!(sights.len() > 30, "{} points", sights.len());
    for (sight, pixel) in sights.iter().zip(answer["pixels"].as_array().expect("pixels")) {
        for (channel, expected) in sight.radiance.into_iter().enumerate() {
            let found = pixel[channel].as_f64().expect("a number");
            let slack = 0.006 * sight.peak;
            assert!(
                (found - expected).abs() <= slack,
                "channel {channel} at {}: three.js shows {found}, computed was {expected} ± {slack}",
                sight.point
            );
        }
    }
}
