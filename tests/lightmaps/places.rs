//! Lightmap layout, for random parts in random places.

use super::{point_of, scene};
use equilux_assemble::lightmap::atlas::Atlas;
use equilux_assemble::lightmap::grid::MARGIN;
use equilux_assemble::lightmap::side::sides;
use equilux_assemble::lightmap::texels::{Texel, Texels, bilinear};
use equilux_formats::{MaterialId, Part, Scene};
use equilux_tests::curved::{sphere, torus};
use equilux_tests::shapes::{grey, joined, moved, part, rectangle, room, solid, triangle};
use glam::{DAffine3, DQuat, DVec3, dvec3};
use proptest::prelude::*;

fn vector(reach: f64) -> impl Strategy<Value = DVec3> {
    prop::array::uniform3(-reach..reach).prop_map(DVec3::from_array)
}

/// A similarity, perhaps a mirror.
fn placement() -> impl Strategy<Value = DAffine3> {
    (vector(5.0), vector(3.0), 0.2..3.0f64, any::<bool>()).prop_map(|(at, turn, scale, mirror)| {
        let flip = if mirror { dvec3(-1.0, 1.0, 1.0) } else { DVec3::ONE };
        DAffine3::from_scale_rotation_translation(flip * scale, DQuat::from_scaled_axis(turn), at)
    })
}

/// One shape, flat, angular or bent.
fn shape() -> impl Strategy<Value = Part> {
    let corner = || vector(2.0);
    let triangles = |triangles: Vec<[DVec3; 3]>| triangles.into_iter().fold(part(grey(0.5, 0.0)), triangle);
    prop_oneof![
        Just(room(grey(0.5, 0.0), DVec3::ZERO, dvec3(3.0, 2.0, 1.0))),
        Just(solid(grey(0.5, 0.0), DVec3::ZERO, dvec3(0.5, 1.0, 0.01))),
        (0..3usize).prop_map(move |level| triangles(sphere(1.0, level))),
        (2..5usize).prop_map(move |n| triangles(torus((1.0, 0.3), 4 * n, 2 * n))),
        (corner(), corner()).prop_map(|(u, v)| rectangle(
            part(grey(0.5, 0.0)),
            DVec3::ZERO,
            u,
            v.reject_from(u)
        )),
        (corner(), corner(), corner()).prop_map(|(a, b, c)| triangle(part(grey(0.5, 0.0)), [a, b, c])),
        // Tiles of a floor, side by side, some of which meet at half an edge.
        (2..6u32).prop_map(|n| (0..n).fold(part(grey(0.5, 0.0)), |part, i| {
            let at = dvec3(f64::from(i), 0.5 * f64::from(i % 2), 0.0);
            rectangle(part, at, DVec3::X, DVec3::Y)
        })),
    ]
}

fn any_scene() -> impl Strategy<Value = Scene> {
    let shapes = prop::collection::vec((shape(), placement(), any::<bool>()), 1..4);
    (shapes, prop::collection::vec(placement(), 1..4)).prop_map(|(shapes, placements)| {
        let placed = shapes.into_iter().map(|(mut part, placement, double_sided)| {
            part.materials[0].double_sided = double_sided;
            moved(part, placement)
        });
        scene(joined(placed), &placements)
    })
}

/// A tile's texels, all at once.
fn texels_of(scene: &Scene, atlas: &Atlas, tile: usize) -> Texels {
    let tile = atlas.tiles()[tile];
    let (chart, grid) = atlas.chart_of(&tile);
    Texels::new(chart, grid, 0..tile.size[1], tile.instance, scene.instances[tile.instance].placement)
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 48, ..ProptestConfig::default() })]

    /// Rectangles count with their margins, so charts are twice the margin apart.
    #[test]
    fn tiles_lie_in_their_image_and_never_overlap(scene in any_scene(), texel in 0.05..0.6f64) {
        let atlas = Atlas::new(&scene, Some(texel)).expect("a small atlas");
        let mut taken: Vec<Vec<bool>> =
            atlas.images.iter().map(|[width, height]| vec![false; (width * height) as usize]).collect();
        for tile in atlas.tiles() {
            let [width, height] = atlas.images[tile.spot.image];
            let [left, top] = tile.spot.at;
            let [right, bottom] = [left + tile.size[0], top + tile.size[1]];
            prop_assert!(right <= width && bottom <= height, "{tile:?} in an image of {width} × {height}");
            for (x, y) in (top..bottom).flat_map(|y| (left..right).map(move |x| (x, y))) {
                let texel = &mut taken[tile.spot.image][(y * width + x) as usize];
                prop_assert!(!std::mem::replace(texel, true), "texel {x}, {y} belongs to two charts");
            }
        }
    }

    #[test]
    fn every_point_maps_to_one_texel_of_its_own_chart_and_back(
        scene in any_scene(), texel in 0.05..0.6f64, (across, along) in (0.0..=1.0f64, 0.0..=1.0f64),
    ) {
        let atlas = Atlas::new(&scene, Some(texel)).expect("a small atlas");
        let charts = &atlas.layouts[0].charts;
        let count: usize = charts.iter().map(|chart| chart.sides.len()).sum();
        prop_assert_eq!(count, sides(&scene.parts[0]).len(), "sides in charts, and in the part");
        for (number, tile) in atlas.tiles().iter().enumerate() {
            let (chart, grid) = atlas.chart_of(tile);
            let texels = texels_of(&scene, &atlas, number);
            let placement = scene.instances[tile.instance].placement;
            for (side, &plane) in chart.sides.iter().zip(&chart.planes) {
                let point = point_of(side.corners.as_slice(), across, along);
                let place = grid.texel_of(plane, point);
                // A point on the line between two texels belongs to either.
                let own = |t: &&Texel| (0..2).all(|i| (place[i] - 0.5 - f64::from(t.at[i])).abs() <= 0.5 + 1e-6);
                let facing = placement.transform_vector3(side.normal).normalize();
                let found = texels.texels.iter().filter(own).flat_map(|t| &t.footprints);
                prop_assert!(
                    found.clone().any(|piece| piece.patch == plane && piece.normal.dot(facing) > 1.0 - 1e-9),
                    "no footprint at {} of chart {}", place, tile.chart
                );
                let (there, back) = (placement.transform_point3(point), texels.patches[plane].point(place));
                // Corners lie in their plane to within 2.4e-7 of the largest coordinate, here at most 30, times 3 for the
                // scale; seen aslant by 30° that is a sixth more.
                prop_assert!((there - back).length() <= 3e-5, "{there} became {back}");
                let [width, height] = tile.size.map(f64::from);
                let inner = f64::from(MARGIN) + 0.5 - 1e-6;
                prop_assert!(
                    place.min_element() >= inner && place.x <= width - inner && place.y <= height - inner,
                    "{place} is in the margin of {width} × {height}"
                );
                prop_assert!(bilinear(place, tile.size[0]).iter().all(|&(i, _)| i < (width * height) as usize));
            }
        }
    }

    #[test]
    fn footprints_add_up_to_the_surface(scene in any_scene(), texel in 0.05..0.6f64) {
        let atlas = Atlas::new(&scene, Some(texel)).expect("a small atlas");
        let whole: f64 = sides(&scene.parts[0]).iter().map(|side| side.area).sum();
        let expected: f64 = scene.instances.iter().map(|i| whole * i.scale().powi(2)).sum();
        let footprint = |tile: usize| texels_of(&scene, &atlas, tile).texels.iter().map(Texel::area).sum::<f64>();
        let found: f64 = (0..atlas.tiles().len()).map(footprint).sum();
        // Rounding of some thousand pieces.
        prop_assert!((found / expected - 1.0).abs() < 1e-12, "{found} m² of footprints, {expected} m² of surface");
    }
}

/// Walls that fill their rectangles: each texel inside has the same area, those on the edges half, in corners a quarter.
#[test]
fn a_turned_wall_fills_its_rectangle() {
    let turn = DQuat::from_scaled_axis(dvec3(0.3, -0.5, 0.8));
    let wall = rectangle(part(grey(0.5, 0.0)), DVec3::ONE, turn * DVec3::X * 3.0, turn * DVec3::Y * 2.0);
    let scene = scene(wall, &[DAffine3::IDENTITY]);
    let atlas = Atlas::new(&scene, Some(0.25)).expect("a small atlas");
    let texels = texels_of(&scene, &atlas, 0);
    assert_eq!(
        (atlas.tiles().len(), texels.texels.len()),
        (1, 13 * 9),
        "charts, and texels on a wall of 12 × 8"
    );
    let on_edge = |at: u32, last: u32| if at == MARGIN || at == MARGIN + last { 0.5 } else { 1.0 };
    for texel in &texels.texels {
        let expected = 0.0625 * on_edge(texel.at[0], 12) * on_edge(texel.at[1], 8);
        // Rounding of coordinates around 3.
        assert!(
            (texel.area() - expected).abs() < 1e-12,
            "{:?}: {} m², not {expected}",
            texel.at,
            texel.area()
        );
    }
}

/// A sphere of 1280 triangles in charts of bent surface, not in as many charts as triangles.
#[test]
fn neighbours_of_a_bent_surface_share_charts() {
    let ball = sphere(1.0, 3).into_iter().fold(part(grey(0.5, 0.0)), triangle);
    let charts = equilux_assemble::lightmap::chart::charts(&ball);
    // Caps of 30° cover 1/15 of a sphere each; what is left between them takes some more.
    assert!(charts.len() < 80, "{} charts for a ball of 1280 triangles", charts.len());
    assert!(charts.iter().all(|chart| chart.material == MaterialId(0)));
}
