//! Skies: orientation, illumination, and refused pictures.

use super::floor;
use equilux_assemble::gather::sky::Sky;
use equilux_assemble::outputs::requests::Pictures;
use equilux_bake::oven::prepare::Division;
use equilux_tests::model::{Model, Node};
use equilux_tests::shapes::{grey, part, rectangle, solid};
use equilux_tests::table::Table;
use equilux_tests::workshop::{Workshop, assembled};
use glam::{DVec3, dvec3};
use std::f64::consts::PI;

/// An equirectangular picture of 64 × 32 pixels as a file of that ending.
fn picture(workshop: &Workshop, ending: &str, radiance: impl Fn(DVec3) -> f32) -> std::path::PathBuf {
    let file = workshop.path("sky").with_extension(ending);
    let image = image::Rgb32FImage::from_fn(64, 32, |x, y| {
        let (turn, down) = ((f64::from(x) + 0.5) / 64.0 * 2.0 * PI, (f64::from(y) + 0.5) / 32.0 * PI);
        // The middle of the picture is −Z, its left and right edge +Z, and +X is to the right of the middle.
        let to = dvec3(-turn.sin() * down.sin(), down.cos(), turn.cos() * down.sin());
        image::Rgb([radiance(to); 3])
    });
    image.save(&file).expect("a picture");
    file
}

#[test]
fn a_sky_picture_shines_from_where_it_shows_light() {
    // Two floors back to back, and a wall each way: only surfaces that face the bright side get light.
    let sheet = |u: DVec3, v: DVec3| rectangle(part(grey(0.0, 0.0)), DVec3::ZERO, u, v);
    let facing = [
        ("x", sheet(DVec3::Y, DVec3::Z), DVec3::X),
        ("-x", sheet(DVec3::Z, DVec3::Y), DVec3::NEG_X),
        ("z", sheet(DVec3::X, DVec3::Y), DVec3::Z),
        ("-z", sheet(DVec3::Y, DVec3::X), DVec3::NEG_Z),
        ("y", sheet(DVec3::Z, DVec3::X), DVec3::Y),
        ("-y", sheet(DVec3::X, DVec3::Z), DVec3::NEG_Y),
    ];
    for (ending, towards) in [("exr", DVec3::X), ("hdr", DVec3::NEG_Z), ("exr", DVec3::Y)] {
        for (name, part, normal) in &facing {
            let workshop = Workshop::with(&[Node::new(name, part.clone())]);
            let sky = picture(&workshop, ending, |to| if to.dot(towards) > 0.0 { 1.0 } else { 0.0 });
            let mut job = workshop.job(Division::Authored);
            let table = workshop.path("elements.csv");
            job.settings.sky = Some(Sky::Picture(sky));
            job.outputs.elements = Some(table.clone());
            assembled(&job);
            let found = Table::read(&table).number(0, "H_r");
            // Half the sky is bright: all that surfaces facing it see, none of what surfaces facing away see, and half
            // of what the others see; pixels and cells are a few degrees wide.
            let expected = PI * (1.0 + normal.dot(towards)) / 2.0;
            assert!(
                (found - expected).abs() <= 0.03 * PI,
                "{found} facing {name} under {ending} bright at {towards}, expected {expected}"
            );
        }
    }
}

/// A Radiance picture of 8 × 4 pixels of four bytes each, of which those in column `bright` have the radiance 1.
fn radiance_file(signature: &str, bright: usize) -> Vec<u8> {
    let pixels = (0..8 * 4).map(|pixel| if pixel % 8 == bright { [128, 128, 128, 129] } else { [0; 4] });
    let head = format!("{signature}\nFORMAT=32-bit_rle_rgbe\n\n-Y 4 +X 8\n");
    [head.into_bytes(), pixels.flatten().collect()].concat()
}

/// The column just right of the middle lies between −Z and +X, and so on to the right and around; whichever signature a
/// file has.
#[test]
fn right_of_the_middle_of_a_sky_picture_is_plus_x() {
    let workshop = Workshop::with(&[Node::new("crate", solid(grey(0.0, 0.0), DVec3::ZERO, DVec3::ONE))]);
    let table = workshop.path("elements.csv");
    for (column, turn) in [(4, 22.5_f64), (5, 67.5), (6, 112.5), (0, 202.5), (3, -22.5)] {
        let [first, second] = ["#?RADIANCE", "#?RGBE"].map(|signature| {
            let sky = workshop.path("sky.hdr");
            std::fs::write(&sky, radiance_file(signature, column)).expect("a picture");
            let mut job = workshop.job(Division::Authored);
            job.settings.sky = Some(Sky::Picture(sky));
            job.outputs.elements = Some(table.clone());
            job.outputs.pictures = Pictures::None;
            assembled(&job);
            std::fs::read(&table).expect("a table")
        });
        assert!(first == second, "one picture with two signatures, column {column}");
        // The column's middle, seen from above turned from −Z towards +X.
        let towards = dvec3(turn.to_radians().sin(), 0.0, -turn.to_radians().cos());
        let lit = Table::read(&table);
        for (row, normal) in lit.vectors(["nx", "ny", "nz"]).into_iter().enumerate() {
            let found = lit.number(row, "H_r");
            // All of the column is before a side wall or behind it.
            let expected = normal.y != 0.0 || normal.dot(towards) > 0.0;
            assert_eq!(found > 0.0, expected, "{found} facing {normal}, column {column} bright");
        }
    }
}

#[test]
fn a_sky_does_not_turn_with_the_scene() {
    // One file, turned as a whole: nothing moves as its parts see each other, and the cache holds what it was before.
    let workshop = Workshop::new();
    let sky = picture(&workshop, "exr", |to| if to.x > 0.0 { 1.0 } else { 0.0 });
    let mut job = workshop.job(Division::Authored);
    let table = workshop.path("elements.csv");
    job.settings.sky = Some(Sky::Picture(sky));
    job.outputs.elements = Some(table.clone());
    let sheet = rectangle(part(grey(0.0, 0.0)), DVec3::ZERO, DVec3::Y, DVec3::Z);
    // Half a turn about y makes what looked to +x look to −x.
    for (rotation, expected) in
        [([0.0, 0.0, 0.0, 1.0], PI), ([0.0, 1.0, 0.0, 0.0], 0.0), ([0.0, 0.0, 0.0, 1.0], PI)]
    {
        let turned = Model::of(&[Node::new("sheet", sheet.clone())]);
        turned.with("/nodes/0/rotation", serde_json::json!(rotation)).write(&job.scene);
        assembled(&job);
        let found = Table::read(&table).number(0, "H_r");
        assert!((found - expected).abs() <= 0.03 * PI, "{found} turned by {rotation:?}, expected {expected}");
    }
}

#[test]
fn skies_that_cannot_be_are_named_before_any_work() {
    let workshop = Workshop::with(&[Node::new("floor", floor())]);
    std::fs::write(workshop.path("broken.hdr"), "no picture").expect("a file");
    for (sky, code, says) in [
        ("nothing.exr", 1, "nothing.exr"),
        ("broken.hdr", 1, "broken.hdr"),
        ("-1", 2, "sky"),
        ("1,2", 2, "sky"),
    ] {
        let ended = workshop.run("assemble", &["scene.glb", &format!("--sky={sky}")]);
        assert_eq!(ended.code, Some(code), "{sky}: {}", ended.stderr);
        assert!(ended.stderr.contains(says), "{sky}: {}", ended.stderr);
    }
    assert!(!workshop.path(".equilux").exists(), "nothing is baked under a sky that cannot be");
}
