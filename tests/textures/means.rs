//! Averages of textures and vertex colours over elements, compared with values computed by hand.

use super::*;
use equilux_bake::elements::bisect::Cut;
use equilux_formats::Material;
use equilux_tests::curved::sphere;
use equilux_tests::shapes::triangle;
use glam::{dvec2, dvec3};
use std::f64::consts::PI;

fn checkers(x: u32, y: u32) -> [u8; 4] {
    if (x + y).is_multiple_of(2) { [255, 128, 40, 255] } else { [64, 16, 200, 255] }
}

#[test]
fn a_checkered_wall_reflects_its_average() {
    let workshop = Workshop::new();
    std::fs::write(workshop.path("checkers.png"), png(8, 6, checkers)).expect("an image");
    let (offset, rotation, scale) = (dvec2(0.13, -0.4), 0.3, dvec2(3.7, 2.9));
    let transform = json!({ "offset": offset.to_array(), "rotation": rotation, "scale": scale.to_array() });
    wallpaper("checkers.png", transform).write(&workshop.path("scene.glb"));

    // Midpoints of 1500 × 1000 squares: those on outlines of texels, one in ten, err both ways.
    let (mut expected, rows) = ([0.0; 3], 1000_u32);
    for k in 0..rows * rows * 3 / 2 {
        let place = dvec2(f64::from(k % 1500) + 0.5, f64::from(k / 1500) + 0.5) / dvec2(1500.0, 1000.0);
        let texel = transformed(place, offset, rotation, scale) * dvec2(8.0, 6.0);
        let colour = checkers(texel.x.rem_euclid(8.0) as u32, texel.y.rem_euclid(6.0) as u32);
        (0..3).for_each(|c| expected[c] += linear(colour[c]) / f64::from(rows * rows * 3 / 2));
    }
    let cuts = Division::Cuts(vec![Cut { axis: 0, offset: 1.234 }, Cut { axis: 1, offset: 0.77 }]);
    for (size, division) in [
        (ElementSize::Mesh, Division::Authored),
        (ElementSize::Metres(0.37), Division::Authored),
        (ElementSize::Metres(0.37), cuts),
    ] {
        let [found, _] = averages(&prepared(&workshop, size, division.clone()));
        for c in 0..3 {
            let off = (found[c] / expected[c] - 1.0).abs();
            assert!(off < 1e-3, "{size}, {division:?}: {found:?} is {off} off {expected:?}");
        }
    }
}

#[test]
fn each_element_has_the_texels_it_lies_on() {
    let workshop = Workshop::new();
    // As many texels as elements: each element is a texel, the first row at the top.
    let texel = |x: u32, y: u32| [30 * x as u8 + 20 * y as u8, 0, 0, 255];
    std::fs::write(workshop.path("rows.png"), png(6, 4, texel)).expect("an image");
    wallpaper("rows.png", json!({})).write(&workshop.path("scene.glb"));
    for division in [Division::Authored, Division::Bisect(2)] {
        let prepared = prepared(&workshop, ElementSize::Metres(0.5), division);
        let mut met = 0;
        for (part, instance) in prepared.parts.iter().zip(&prepared.instances) {
            for (i, element) in part.geometry.elements.iter().enumerate() {
                let place = instance.placement.transform_point3(element.centroid);
                let (x, y) = ((place.x / 0.5) as u32, ((2.0 - place.y) / 0.5) as u32);
                let (found, expected) = (part.optics.reflectance[i][0], linear(texel(x, y)[0]));
                // Positions are f32.
                assert!((found - expected).abs() < 1e-5, "{found} at {place}, expected {expected}");
                met += 1;
            }
        }
        assert_eq!(met, 24);
    }
}

#[test]
fn half_lit_texels_emit_half() {
    let workshop = Workshop::new();
    let lit = |x: u32, _| if x.is_multiple_of(2) { [255; 4] } else { [0, 0, 0, 255] };
    std::fs::write(workshop.path("lamps.png"), png(16, 1, lit)).expect("an image");
    let model = Model::of(&[Node::new("wall", wall(grey(0.5, 5.0 * PI)))]);
    let mut model = with_coordinates(model, |p| [p.x / 3.0, p.y / 2.0]);
    model.json["materials"][0]["emissiveTexture"] = json!(null);
    with_image(model, "/emissiveTexture", "lamps.png", json!({}), json!({}))
        .write(&workshop.path("scene.glb"));
    for size in [ElementSize::Mesh, ElementSize::Metres(0.4)] {
        let [reflectance, emission] = averages(&prepared(&workshop, size, Division::Authored));
        // Numbers in the file are f32.
        assert!((emission[1] / (2.5 * PI) - 1.0).abs() < 1e-6, "{emission:?}, expected {}", 2.5 * PI);
        assert!((reflectance[1] - 0.5).abs() < 1e-6, "{reflectance:?}, nothing is painted on it");
    }
}

/// A ball and leaning quads whose coordinates are one point of a palette, or lie on a line or within 1e-7 there.
#[test]
fn faces_on_one_colour_of_a_palette_have_it_everywhere() {
    let workshop = Workshop::new();
    let colour = |x: u32, y: u32| [20 + 60 * x as u8, 50 * y as u8, 7, 255];
    std::fs::write(workshop.path("palette.png"), png(4, 4, colour)).expect("an image");
    let ball =
        sphere(0.7, 2).into_iter().fold(part(Material { double_sided: true, ..grey(1.0, 0.0) }), triangle);
    let shape = (0..12).fold(ball, |part, k| {
        let (sine, cosine) = (f64::from(k) * 0.61).sin_cos();
        rectangle(
            part,
            dvec3(2.0 * cosine, -0.3, 2.0 * sine),
            dvec3(-sine, 0.1, cosine),
            dvec3(0.03, 1.1, 0.2 * sine),
        )
    });
    let shape = Model::of(&[Node::new("shape", shape)]);
    let coordinates: [fn(Vec3) -> [f32; 2]; 4] = [
        |_| [0.6, 0.3],
        |_| [-1000.4, 7.3],
        |p| [0.6 + 1e-7 * p.x.signum(), 0.3 - 1e-7 * p.y.signum()],
        |p| [0.6 + 0.03 * p.x, 0.3 + 0.006 * p.x],
    ];
    for (number, at) in coordinates.into_iter().enumerate() {
        let mut model = with_coordinates(shape.clone(), at);
        model.json["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"] = json!(null);
        let on = "/pbrMetallicRoughness/baseColorTexture";
        with_image(model, on, "palette.png", json!({}), json!({})).write(&workshop.path("scene.glb"));
        for (size, division) in [
            (ElementSize::Mesh, Division::Authored),
            (ElementSize::Metres(0.1), Division::Authored),
            (ElementSize::Metres(0.3), Division::Bisect(3)),
        ] {
            for found in prepared(&workshop, size, division).parts.iter().flat_map(|p| &p.optics.reflectance)
            {
                let expected = colour(2, 1).map(linear);
                // Linear light is kept in steps of 2^-32.
                let off = (0..3).map(|c| (found[c] - expected[c]).abs()).fold(0.0, f64::max);
                assert!(
                    off < 2f64.powi(-32),
                    "{found:?}, expected {expected:?}, coordinates {number}, {size}"
                );
            }
        }
    }
}

#[test]
fn beyond_its_edge_an_image_goes_on_as_its_sampler_says() {
    let workshop = Workshop::new();
    let half = |x: u32, _| if x == 0 { [255; 4] } else { [0, 0, 0, 255] };
    std::fs::write(workshop.path("half.png"), png(2, 1, half)).expect("an image");
    // From −0.75 to 0.5: white, black, white of 0.25, 0.5, 0.5; or black, white; or white throughout.
    for (wrap, expected) in [(10497, 0.6), (33648, 0.8), (33071, 1.0)] {
        let model = wallpaper("half.png", json!({ "offset": [-0.75, 0.0], "scale": [1.25, 1.0] }));
        model.with("/samplers/0", json!({ "wrapS": wrap })).write(&workshop.path("scene.glb"));
        let found = reflectance(&workshop);
        assert!((found - expected).abs() < 1e-6, "wrapS {wrap}: {found}, expected {expected}");
    }
}

#[test]
fn texture_coordinates_of_another_set_are_used_where_asked_for() {
    let workshop = Workshop::new();
    let half = |x: u32, _| if x == 0 { [255; 4] } else { [0, 0, 0, 255] };
    std::fs::write(workshop.path("half.png"), png(2, 1, half)).expect("an image");
    let second = |model| with_attribute(model, "TEXCOORD_1", "VEC2", |p| vec![p.x / 12.0, 0.0]);
    let model = second(wallpaper("half.png", json!({})));
    let by_info = model
        .clone()
        .with("/materials/0/pbrMetallicRoughness/baseColorTexture", json!({ "index": 0, "texCoord": 1 }));
    let by_transform = second(wallpaper("half.png", json!({ "texCoord": 1 })));
    for (model, expected) in [(model, 0.5), (by_info, 1.0), (by_transform, 1.0)] {
        model.write(&workshop.path("scene.glb"));
        let found = reflectance(&workshop);
        assert!((found - expected).abs() < 1e-6, "{found}, expected {expected}");
    }
}

#[test]
fn vertex_colours_are_linear_over_triangles() {
    let workshop = Workshop::new();
    let model = Model::of(&[Node::new("wall", wall(grey(0.5, 0.0)))]);
    let model = with_attribute(model, "COLOR_0", "VEC4", |p| vec![p.x / 3.0, p.y / 2.0, 7.0, 0.5]);
    model.write(&workshop.path("scene.glb"));
    let prepared = prepared(&workshop, ElementSize::Metres(0.3), Division::Authored);
    let part = &prepared.parts[0];
    for (element, found) in part.geometry.elements.iter().zip(&part.optics.reflectance) {
        // The mean of a linear function is its value in the middle; more than full colour is full colour.
        let expected = [element.centroid.x / 6.0, element.centroid.y / 4.0, 0.5];
        for c in 0..3 {
            assert!((found[c] - expected[c]).abs() < 1e-6, "{found:?}, expected {expected:?}");
        }
    }
}

#[test]
fn what_is_not_there_reflects_nothing() {
    let workshop = Workshop::new();
    // A quarter at each alpha; those of 100 and 200 are below and above what is asked for once multiplied by 0.8.
    let texel = |x: u32, _| [255, 255, 255, [0, 100, 200, 255][x as usize]];
    std::fs::write(workshop.path("leaves.png"), png(4, 1, texel)).expect("an image");
    let opaque = wallpaper("leaves.png", json!({}))
        .with("/materials/0/pbrMetallicRoughness/baseColorFactor", json!([1, 1, 1, 0.8]));
    let mask = opaque.clone().with("/materials/0/alphaMode", json!("MASK"));
    let blend = opaque.clone().with("/materials/0/alphaMode", json!("BLEND"));
    let shares = 0.8 * (100.0 + 200.0 + 255.0) / 4.0 / 255.0;
    for (mode, model, expected) in [("OPAQUE", opaque, 1.0), ("MASK", mask, 0.5), ("BLEND", blend, shares)] {
        model.write(&workshop.path("scene.glb"));
        let found = reflectance(&workshop);
        assert!((found - expected).abs() < 1e-6, "{mode}: {found}, expected {expected}");
        let notes = import_scene(&workshop.path("scene.glb")).expect("a scene").notes;
        let said = notes.iter().filter(|note| note.contains("transparent")).count();
        assert_eq!(said, usize::from(mode != "OPAQUE"), "{notes:?}");
    }
}

/// A sheet of two triangles, each with the whole of a 2-texel image in its own way, seen from both sides, and mirrored.
#[test]
fn sides_halves_and_mirrored_copies_keep_their_texels() {
    let workshop = Workshop::new();
    let half = |x: u32, _| if x == 0 { [255; 4] } else { [0, 0, 0, 255] };
    std::fs::write(workshop.path("half.png"), png(2, 1, half)).expect("an image");
    let sheet = wall(Material { double_sided: true, ..grey(1.0, 0.0) });
    let model = Model::of(&[Node::new("sheet", sheet)]);
    // Left of x = 1.5 white, right of it black.
    let model = with_coordinates(model, |p| [p.x / 3.0, 0.0]);
    let mut model = model;
    model.json["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"] = json!(null);
    let mut model =
        with_image(model, "/pbrMetallicRoughness/baseColorTexture", "half.png", json!({}), json!({}));
    model.json["nodes"][0]["scale"] = json!([-1.0, 1.0, 1.0]);
    model.json["nodes"]
        .as_array_mut()
        .expect("nodes")
        .push(json!({ "mesh": 0, "translation": [5.0, 0.0, 0.0] }));
    model.json["scenes"][0]["nodes"] = json!([0, 1]);
    model.write(&workshop.path("scene.glb"));
    for division in [Division::Authored, Division::Cuts(vec![Cut { axis: 0, offset: 0.0 }])] {
        let prepared = prepared(&workshop, ElementSize::Metres(0.5), division);
        for instance in &prepared.instances {
            let part = &prepared.parts[instance.part.index()];
            for (element, found) in part.geometry.elements.iter().zip(&part.optics.reflectance) {
                let x = instance.placement.transform_point3(element.centroid).x;
                let expected = if (x > 0.0 && x < 6.5) || (x < 0.0 && x > -1.5) { 1.0 } else { 0.0 };
                assert!((found[0] - expected).abs() < 1e-6, "{found:?} at {x}, expected {expected}");
            }
        }
    }
}
