//! Image files: edits that compute no form factors, repaints, and refusals.

use super::*;
use equilux_assemble::lightmap::Lightmap;
use equilux_assemble::lightmap::atlas::Atlas;
use equilux_assemble::lightmap::texels::{Texels, bilinear};
use equilux_bake::monitor::Monitor;
use equilux_formats::{Material, Rgb};
use equilux_tests::shapes::room;
use equilux_tests::workshop::assembled;

/// A closed room papered with `paper.png`, and a lamp in it.
fn papered_room(extras: Value) -> Model {
    let paper = Material { name: "paper".into(), ..grey(0.8, 0.1) };
    let mut node = Node::new("room", room(paper, DVec3::ZERO, DVec3::splat(2.0)));
    node.extras = extras;
    let mut model = with_coordinates(Model::of(&[node]), |p| [p.x + 0.3 * p.z, p.y]);
    model.json["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"] = json!(null);
    with_image(model, "/pbrMetallicRoughness/baseColorTexture", "paper.png", json!({}), json!({}))
}

fn stripes(dark: u8) -> Vec<u8> {
    png(4, 1, |x, _| if x % 2 == 0 { [255; 4] } else { [dark, dark, dark, 255] })
}

#[test]
fn another_image_or_colour_computes_no_form_factors() {
    let workshop = Workshop::new();
    let paper = workshop.path("paper.png");
    std::fs::write(&paper, stripes(0)).expect("an image");
    papered_room(json!({})).write(&workshop.path("scene.glb"));
    let scene = import_scene(&workshop.path("scene.glb")).expect("a scene");
    assert!(scene.sources.iter().any(|source| source.ends_with("paper.png")), "{:?}", scene.sources);
    let job = workshop.job(Division::Authored);
    assert!(assembled(&job).form_factors_computed > 0);
    let light = || {
        let mut job = job.clone();
        job.outputs.elements = Some(workshop.path("elements.csv"));
        assert_eq!(assembled(&job).form_factors_computed, 0);
        std::fs::read(workshop.path("elements.csv")).expect("a table")
    };
    let before = light();
    std::fs::write(&paper, stripes(200)).expect("an image");
    assert_ne!(before, light(), "another image, the same light");
    std::fs::write(&paper, stripes(0)).expect("an image");
    papered_room(json!({ "materials": { "paper": { "baseColorFactor": [0.4, 0.8, 0.8, 1.0] } } }))
        .write(&workshop.path("scene.glb"));
    assert_ne!(before, light(), "another colour, the same light");
}

#[test]
fn a_repainted_material_keeps_its_texture() {
    let workshop = Workshop::new();
    std::fs::write(workshop.path("paper.png"), stripes(0)).expect("an image");
    let repaint = json!({ "materials": { "paper": { "baseColorFactor": [0.4, 0.2, 0.0, 1.0] } } });
    papered_room(repaint).write(&workshop.path("scene.glb"));
    let scene = prepared(&workshop, ElementSize::Mesh, Division::Authored);
    let part = &scene.parts[0];
    let repainted = &scene.instances[0].repainted;
    let here =
        equilux_bake::elements::repainted(&part.geometry, &part.optics, &part.tints, repainted).reflectance;
    for (here, plain) in here.iter().zip(&part.optics.reflectance) {
        let share = plain[0] / 0.8;
        let expected = [0.4 * share, 0.2 * share, 0.0];
        // The file's 0.8 is an f32.
        let near = (0..3).all(|c| (here[c] - expected[c]).abs() < 1e-6);
        assert!(near && share > 0.3 && share < 0.7, "{here:?}, expected {expected:?}");
    }
}

#[test]
fn images_that_cannot_be_read_are_named() {
    let refusal = |uri: &str| {
        let workshop = Workshop::new();
        std::fs::write(workshop.path("broken.png"), &stripes(0)[..60]).expect("an image");
        std::fs::write(workshop.path("words.jpg"), "no image").expect("an image");
        wallpaper(uri, json!({})).write(&workshop.path("scene.glb"));
        import_scene(&workshop.path("scene.glb")).expect_err(uri).to_string()
    };
    for (uri, expected) in [
        ("broken.png", vec!["scene.glb", "image broken.png cannot be decoded", "PNG, JPEG or WebP"]),
        ("words.jpg", vec!["image words.jpg cannot be decoded (neither PNG nor JPEG nor WebP)"]),
        ("missing.png", vec!["scene.glb", "'missing.png'", "cannot be read", "an existing file"]),
        ("../paper.png", vec!["'../paper.png'", "leaves the scene's folder"]),
        ("https://example.org/a.png", vec!["is a URL"]),
        ("data:image/png;base64,iVBORw0KGgo=", vec!["image 0 cannot be decoded"]),
        ("data:image/png,abc", vec!["image 0 cannot be decoded (neither PNG nor JPEG nor WebP)"]),
    ] {
        let error = refusal(uri);
        for words in expected {
            assert!(error.contains(words), "{uri}: expected '{words}' in: {error}");
        }
    }
}

#[test]
fn lightmaps_show_what_is_painted() {
    let workshop = Workshop::new();
    let texel = |x: u32, y: u32| [30 * x as u8 + 20 * y as u8, 0, 255, 255];
    std::fs::write(workshop.path("rows.png"), png(6, 4, texel)).expect("an image");
    let mut model = wallpaper("rows.png", json!({}));
    model.json["nodes"][0]["scale"] = json!([-1.0, 1.0, 1.0]);
    model.write(&workshop.path("scene.glb"));
    let scene = import_scene(&workshop.path("scene.glb")).expect("a scene");
    let atlas = Atlas::new(&scene, Some(0.05)).expect("a small atlas");
    let lit = |texels: &Texels| vec![Rgb::splat(2.0); texels.texels.len()];
    let lightmap = Lightmap::new(&scene, &atlas, lit, &Monitor::default()).expect("not stopped");
    assert_eq!(lightmap.tiles.len(), 1);
    let (_, grid) = atlas.chart_of(&lightmap.tiles[0]);
    for (x, y) in (0..6).flat_map(|x| (0..4).map(move |y| (x, y))) {
        let middle = DVec3::new(0.5 * f64::from(x) + 0.25, 1.75 - 0.5 * f64::from(y), 0.0);
        let looked_up = bilinear(grid.texel_of(0, middle), lightmap.tiles[0].size[0]);
        let found: f64 = looked_up.iter().map(|&(i, w)| w * lightmap.radiosity(0, i)[0]).sum();
        let expected = 2.0 * linear(texel(x, y)[0]);
        // Positions are f32.
        assert!((found - expected).abs() < 1e-5, "{found} at {middle}, expected {expected}");
    }
}
