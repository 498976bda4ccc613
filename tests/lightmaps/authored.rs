//! Authored lightmap layouts (TEXCOORD_1) are kept if they are suitable.

use super::{lookup, point_of, scene};
use equilux_assemble::lightmap::atlas::Atlas;
use equilux_assemble::lightmap::texels::{Texel, Texels};
use equilux_assemble::lightmap::{Lightmap, Units};
use equilux_bake::gltf_import::import_scene;
use equilux_bake::monitor::Monitor;
use equilux_formats::{Instance, Part, Rgb, Scene};
use equilux_tests::model::{Model, Node};
use equilux_tests::shapes::{grey, solid};
use equilux_tests::workshop::Workshop;
use glam::{DAffine3, DMat2, DVec2, DVec3, dvec2, dvec3};
use std::path::Path;

/// A box whose six sides lie in a turned grid of 3 × 2 cells, `gap` apart in widths of the layout.
fn laid_out(gap: f64) -> Part {
    let mut part = solid(grey(0.5, 1.0), DVec3::ZERO, dvec3(1.0, 0.75, 0.5));
    for (number, surface) in part.surfaces.iter_mut().enumerate() {
        let cell = dvec2((number % 3) as f64, (number / 3) as f64) * 0.3;
        let place =
            |corner: DVec2| DMat2::from_angle(0.05) * (cell + corner * (0.3 - gap)) + dvec2(0.05, 0.02);
        surface.lightmap = Some([DVec2::ZERO, DVec2::X, DVec2::ONE, DVec2::Y].map(place));
    }
    part
}

/// Two places: as it stands, and small and mirrored.
fn scene_of(part: Part) -> Scene {
    scene(part, &[DAffine3::IDENTITY, DAffine3::from_scale(dvec3(0.5, -0.5, 0.5))])
}

#[test]
fn a_valid_layout_is_kept_and_takes_light_without_bleeding() {
    let mut part = laid_out(0.05);
    part.materials[0].double_sided = true;
    let scene = scene_of(part.clone());
    let atlas = Atlas::new(&scene, Some(0.05)).expect("an atlas");
    assert_eq!((atlas.notes.len(), atlas.layouts[0].sheets.len()), (0, 2), "{:?}, and sheets", atlas.notes);
    // Light of its own for each side of each surface.
    let light = |texels: &Texels| {
        vec![Rgb(texels.patches[0].normal.to_array().map(|x| 2.0 + x)); texels.texels.len()]
    };
    let lightmap = Lightmap::new(&scene, &atlas, light, &Monitor::default()).expect("not stopped");
    let (mut area, mut bled) = (0.0, 0.0f64);
    for (number, tile) in lightmap.tiles.iter().enumerate() {
        let (chart, grid) = atlas.chart_of(tile);
        let placement = scene.instances[tile.instance].placement;
        let texels = Texels::new(chart, grid, 0..tile.size[1], tile.instance, placement);
        area += texels.texels.iter().map(Texel::area).sum::<f64>();
        let layout = atlas.layout_of(tile.instance);
        let inner = f64::from(layout.sheets[0][0] - 2 * layout.border);
        for (side, &plane) in chart.sides.iter().zip(&chart.planes) {
            let (corners, places) = (side.corners.as_slice(), side.lightmap.expect("places"));
            for k in 0..25 {
                let (across, along) = (f64::from(k % 5) / 4.0, f64::from(k / 5) / 4.0);
                let point = point_of(corners, across, along);
                let authored =
                    places[0].lerp(places[1], across).lerp(places[3].lerp(places[2], across), along);
                let at = dvec2(
                    f64::from(layout.spots[tile.chart].at[0]),
                    f64::from(layout.spots[tile.chart].at[1]),
                );
                let found = (grid.texel_of(plane, point) + at - f64::from(layout.border)) / inner;
                // Rounding of f64.
                assert!(
                    (found - authored).length() < 1e-12,
                    "{point} lies at {found}, the author put it at {authored}"
                );
                let expected = 2.0 + placement.transform_vector3(side.normal).normalize().x;
                bled = bled.max((lookup(&lightmap, number, plane, point)[0] - expected).abs());
            }
        }
    }
    // Both sides of the box, and of one of half its size; rounding.
    let expected = 2.0 * 1.25 * 2.0 * (1.0 * 0.75 + 0.75 * 0.5 + 1.0 * 0.5);
    assert!((area / expected - 1.0).abs() < 1e-12, "{area} m² of footprints, {expected} m² of surface");
    assert!(bled < 1e-14, "a lookup is off by {bled}");
}

/// Texels with some of a chart, in all images, belong to one chart.
#[test]
fn charts_of_a_layout_share_no_texel() {
    let scene = scene_of(laid_out(0.05));
    let atlas = Atlas::new(&scene, Some(0.05)).expect("an atlas");
    assert!(atlas.layouts.iter().all(|layout| layout.border > 0), "kept: {:?}", atlas.notes);
    let [width, height] = atlas.images[0];
    let mut owners = vec![None; (width * height) as usize];
    for (number, tile) in atlas.tiles().iter().enumerate() {
        let (chart, grid) = atlas.chart_of(tile);
        for texel in Texels::new(chart, grid, 0..tile.size[1], 0, DAffine3::IDENTITY).texels {
            let [x, y] = [0, 1].map(|i| tile.spot.at[i] + texel.at[i]);
            let before = owners[(y * width + x) as usize].replace(number);
            assert!(before.is_none(), "texel {x}, {y} belongs to charts {before:?} and {number}");
        }
    }
}

#[test]
fn a_layout_that_cannot_hold_light_is_laid_out_anew_and_the_report_says_why() {
    let changed = |change: fn(&mut Part)| {
        let mut part = laid_out(0.02);
        change(&mut part);
        part
    };
    for (why, part) in [
        ("is not on all surfaces", changed(|part| part.surfaces[2].lightmap = None)),
        (
            "reaches outside",
            changed(|part| part.surfaces[2].lightmap = part.surfaces[2].lightmap.map(|p| p.map(|p| p * 1.5))),
        ),
        ("over each other", changed(|part| part.surfaces[2].lightmap = part.surfaces[0].lightmap)),
        ("no area", changed(|part| part.surfaces[2].lightmap = Some([DVec2::ZERO; 4]))),
        ("too near", laid_out(1e-4)),
        (
            "fills too little",
            changed(|part| {
                part.surfaces.iter_mut().for_each(|s| s.lightmap = s.lightmap.map(|p| p.map(|p| p * 1e-3)))
            }),
        ),
    ] {
        let atlas = Atlas::new(&scene_of(part), Some(0.05)).expect("an atlas");
        assert!(
            atlas.notes.len() == 1 && atlas.notes[0].contains(why),
            "expected '{why}', found {:?}",
            atlas.notes
        );
        assert!(atlas.layouts.iter().all(|layout| layout.border == 0 && layout.charts.len() == 6));
    }
}

/// TEXCOORD_1 of lightmapped.glb is that of the source, so that a lightmap fits the author's own model.
#[test]
fn texture_coordinates_come_through_files_as_they_were() {
    let part = laid_out(0.02);
    let workshop = super::files::baked(&[Node::new("box", part.clone())], Units::Irradiance);
    let read = |path: &Path| {
        let Scene { parts, instances, .. } = import_scene(path).unwrap_or_else(|error| panic!("{error}"));
        let Instance { placement, .. } = instances[0];
        let surfaces = parts[0].surfaces.iter();
        surfaces.map(|s| (s.placed(placement).corners, s.placed(placement).lightmap)).collect::<Vec<_>>()
    };
    let (source, written) =
        (read(&workshop.path("scene.glb")), read(&workshop.path("out/scene/lightmapped.glb")));
    assert_eq!(source.len(), written.len(), "surfaces");
    for (corners, places) in source {
        let (_, found) = written.iter().find(|(other, _)| *other == corners).expect("the same surface");
        let (places, found) = (places.expect("places"), found.expect("places"));
        let off = (0..4).map(|i| (places[i] - found[i]).length()).fold(0.0, f64::max);
        // f32 coordinates up to 1, written twice.
        assert!(off < 2e-7, "{places:?} became {found:?}");
    }
}

#[test]
fn damaged_lightmap_coordinates_are_refused_or_named() {
    let model = Model::of(&[Node::new("box", laid_out(0.02))]);
    let mut infinite = model.clone();
    let end = infinite.binary.len();
    infinite.binary[end - 4..].copy_from_slice(&f32::INFINITY.to_le_bytes());
    let workshop = Workshop::new();
    infinite.write(&workshop.path("scene.glb"));
    let scene = import_scene(&workshop.path("scene.glb")).expect("a scene");
    assert!(scene.notes.iter().any(|note| note.contains("TEXCOORD_1")), "{:?}", scene.notes);
    assert!(scene.parts[0].surfaces.iter().all(|s| s.lightmap.is_none() && s.corners.as_slice().len() == 4));
    let damaged = model.with("/accessors/1/count", 7.into());
    damaged.write(&workshop.path("scene.glb"));
    let error = import_scene(&workshop.path("scene.glb")).expect_err("seven places for 36 corners");
    assert!(error.to_string().contains("TEXCOORD_1"), "{error}");
}
