//! The light in lightmaps.

use super::{lookup, point_of, scene};
use equilux_assemble::lightmap::Lightmap;
use equilux_assemble::lightmap::atlas::Atlas;
use equilux_bake::monitor::Monitor;
use equilux_formats::{Rgb, Scene};
use equilux_tests::curved::sphere;
use equilux_tests::shapes::{grey, joined, moved, part, solid, triangle};
use glam::{DAffine3, DQuat, DVec3, dvec3};

/// Boxes and a ball, once as they are, once small, turned and mirrored.
fn shapes() -> Scene {
    let small = DAffine3::from_scale_rotation_translation(
        dvec3(-0.5, 0.5, 0.5),
        DQuat::from_scaled_axis(dvec3(0.1, 0.7, -0.3)),
        dvec3(4.0, 0.0, 0.0),
    );
    let ball = sphere(0.5, 2).into_iter().fold(part(grey(0.5, 0.0)), triangle);
    let boxes = [0.0, 0.7].map(|x| solid(grey(0.5, 0.0), dvec3(x, 1.0, 0.0), dvec3(x + 0.6, 2.0, 0.31)));
    let turned = moved(boxes[0].clone(), DAffine3::from_rotation_z(0.4));
    scene(joined([ball, boxes[0].clone(), boxes[1].clone(), turned]), &[DAffine3::IDENTITY, small])
}

/// Points all over the sides of every tile: where they are, and what a lookup there gives.
fn lookups<'a>(lightmap: &'a Lightmap) -> impl Iterator<Item = (usize, DVec3, f64)> + 'a {
    (0..lightmap.tiles.len()).flat_map(move |tile| {
        let (chart, _) = lightmap.atlas.chart_of(&lightmap.tiles[tile]);
        let places = (0..=4).flat_map(|i| (0..=4).map(move |j| (f64::from(i) / 4.0, f64::from(j) / 4.0)));
        let sides = chart.sides.iter().zip(&chart.planes);
        let sides = sides.flat_map(move |side| places.clone().map(move |place| (side, place)));
        sides.map(move |((side, &plane), (across, along))| {
            let point = point_of(side.corners.as_slice(), across, along);
            (tile, point, lookup(lightmap, tile, plane, point)[1])
        })
    })
}

#[test]
fn charts_do_not_bleed_into_each_other() {
    let mut scene = shapes();
    // Boxes only: their sides meet at right angles, so no seam makes neighbours agree.
    scene.parts[0].surfaces.retain(|s| s.corners.as_slice().len() == 4);
    let atlas = Atlas::new(&scene, Some(0.07)).expect("a small atlas");
    let white = |normal: DVec3| f64::from(normal.x > 0.0);
    let lightmap = Lightmap::new(
        &scene,
        &atlas,
        |texels| texels.texels.iter().map(|_| Rgb::splat(white(texels.patches[0].normal))).collect(),
        &Monitor::default(),
    )
    .expect("not stopped");
    let mut seen = [0, 0];
    for (tile, point, value) in lookups(&lightmap) {
        let (chart, _) = atlas.chart_of(&lightmap.tiles[tile]);
        let placement = scene.instances[lightmap.tiles[tile].instance].placement;
        let expected = white(placement.transform_vector3(chart.direction));
        seen[expected as usize] += 1;
        // Weights of a lookup add up to one within rounding.
        assert!((value - expected).abs() < 1e-14, "{value} at {point} of chart {tile}, expected {expected}");
    }
    assert!(seen[0] > 100 && seen[1] > 100, "black and white lookups: {seen:?}");
}

/// Dilation and seams change nothing where all is equal.
#[test]
fn even_light_stays_even_everywhere() {
    let scene = shapes();
    let atlas = Atlas::new(&scene, None).expect("an atlas");
    let even = |texels: &equilux_assemble::lightmap::texels::Texels| {
        vec![Rgb([0.25, 0.5, 0.75]); texels.texels.len()]
    };
    let lightmap = Lightmap::new(&scene, &atlas, even, &Monitor::default()).expect("not stopped");
    for (tile, point, value) in lookups(&lightmap) {
        assert!((value - 0.5).abs() < 1e-14, "{value} at {point} of chart {tile}, expected 0.5");
    }
}

/// A request to stop ends a lightmap; one from before it began, which ended the exchange, does not.
#[test]
fn a_lightmap_can_be_stopped_while_it_is_made() {
    let scene = shapes();
    let atlas = Atlas::new(&scene, Some(0.2)).expect("an atlas");
    let monitor = Monitor::default();
    let stops = |texels: &equilux_assemble::lightmap::texels::Texels| {
        monitor.stop();
        vec![Rgb::WHITE; texels.texels.len()]
    };
    assert!(Lightmap::new(&scene, &atlas, stops, &monitor).is_err(), "stopped at its first texels");
    assert!(Lightmap::new(&scene, &atlas, stops, &monitor).is_ok(), "stopped long before");
}

/// The default gives an image of about 1024² texels for scenes of any size.
#[test]
fn the_default_texel_size_suits_the_scene() {
    for size in [1e-3, 1.0, 1e3] {
        let mut scene = shapes();
        let scaled = DAffine3::from_scale(DVec3::splat(size));
        scene.instances.iter_mut().for_each(|i| i.placement = scaled * i.placement);
        let atlas = Atlas::new(&scene, None).expect("an atlas");
        let texels: f64 = atlas.images.iter().map(|[w, h]| f64::from(*w) * f64::from(*h)).sum();
        let ratio = texels / f64::from(1 << 20);
        // Packing wastes up to a tenth more or less than assumed, and the size is rounded to two digits, 5 % at most.
        assert!(
            (0.75..1.25).contains(&ratio),
            "scale {size}: {:?} texels of {} m",
            atlas.images,
            atlas.texel_size
        );
    }
}

#[test]
fn what_no_image_can_hold_is_refused_and_what_one_cannot_gets_several() {
    let scene = shapes();
    let refused = Atlas::new(&scene, Some(1e-5)).expect_err("1e10 texels");
    assert!(refused.to_string().contains("--texel-size"), "{refused}");
    let atlas = Atlas::new(&scene, Some(5e-4)).expect("an atlas of several images");
    assert!(atlas.images.len() > 1, "{:?}", atlas.images);
    assert!(atlas.images.iter().flatten().all(|&side| side <= 4096), "{:?}", atlas.images);
}
