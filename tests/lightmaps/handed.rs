//! A layout (TEXCOORD_1) may mirror any of its islands without a change of light.

use super::{lookup, point_of, scene};
use equilux_assemble::lightmap::LightmapOptions;
use equilux_assemble::lightmap::atlas::{Atlas, Tile};
use equilux_assemble::outputs::requests::Pictures;
use equilux_bake::elements::ElementSize;
use equilux_bake::oven::prepare::{Division, Preparation, RowMethod};
use equilux_bake::treecode::EXACT;
use equilux_formats::{Material, Part, Rgb};
use equilux_tests::lit::{lightmap, lit_scene};
use equilux_tests::model::{Model, Node};
use equilux_tests::shapes::{grey, joined, part, rectangle, solid};
use equilux_tests::workshop::{Workshop, assembled};
use glam::{DAffine3, DVec2, DVec3, dvec2, dvec3};
use proptest::prelude::*;
use std::f64::consts::PI;

/// Give the up to six surfaces of a part places in 3 × 2 cells, each turned and mirrored as `ways` say.
fn laid_out(mut part: Part, ways: &[usize]) -> Part {
    for (number, (surface, way)) in part.surfaces.iter_mut().zip(ways.iter().cycle()).enumerate() {
        let mut places = [DVec2::ZERO, DVec2::X, DVec2::ONE, DVec2::Y];
        places.rotate_left(way % 4);
        if way / 4 % 2 == 1 {
            places.reverse();
        }
        let cell = dvec2((number % 3) as f64, (number / 3) as f64);
        let place = |corner: DVec2| (cell + 0.1 + 0.8 * corner) * dvec2(1.0 / 3.0, 0.5);
        surface.lightmap = Some(places.map(place));
    }
    part
}

/// As it stands, mirrored, small, and small and mirrored; far from each other.
fn places() -> [DAffine3; 4] {
    let scales = [DVec3::ONE, dvec3(-1.0, 1.0, 1.0), DVec3::splat(0.5), dvec3(0.5, 0.5, -0.5)];
    let mut at = -1e4;
    scales.map(|scale| {
        at += 2e4;
        DAffine3::from_scale_rotation_translation(scale, glam::DQuat::from_rotation_y(0.3), DVec3::X * at)
    })
}

/// Six sheets in a row.
fn sheets(paint: Material) -> Part {
    (0..6)
        .fold(part(paint), |part, k| rectangle(part, DVec3::X * f64::from(2 * k), DVec3::X, DVec3::Z * 0.75))
}

fn mesh() -> Preparation {
    Preparation {
        element_size: Some(ElementSize::Mesh),
        division: Division::Authored,
        resolution: EXACT,
        rows: RowMethod::Exact,
        rays: 256,
        local_solver: None,
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    /// Case 35: a sky from all around shines with π L on every side of a box, and on both of sheets in a plane.
    #[test]
    fn every_texel_that_sees_nothing_but_an_even_sky_has_pi_times_its_radiance(
        ways in prop::collection::vec(0..8_usize, 6),
        double_sided in any::<bool>(),
        place in 0..4_usize,
    ) {
        let shape = match double_sided {
            false => solid(grey(0.0, 0.0), DVec3::ZERO, dvec3(1.0, 0.75, 0.5)),
            true => sheets(Material { double_sided, ..grey(0.0, 0.0) }),
        };
        let scene = scene(laid_out(shape, &ways), &places()[place..=place]);
        let atlas = Atlas::new(&scene, Some(0.04)).expect("an atlas");
        prop_assert!(atlas.layouts[0].border > 0, "the layout is kept: {:?}", atlas.notes);
        let map = lightmap(&scene, &atlas, &lit_scene(&scene, &mesh()), 2.0);
        for (number, tile) in map.tiles.iter().enumerate() {
            let (chart, _) = atlas.chart_of(tile);
            for k in 0..25 {
                let at = point_of(chart.sides[0].corners.as_slice(), f64::from(k % 5) / 4.0, f64::from(k / 5) / 4.0);
                let found = lookup(&map, number, 0, at)[0];
                // Rows of the sky's cells sum to one within rounding.
                prop_assert!((found - 2.0 * PI).abs() < 1e-9, "{} at {} of chart {}, expected 2 π", found, at, number);
            }
        }
    }
}

/// What a lookup gives off the middle of each side of an open box below a lamp, whose islands lie as `ways` say, W/m².
fn light_in_open_box(ways: &[usize], placement: DAffine3) -> Vec<f64> {
    let mut open =
        solid(Material { double_sided: true, ..grey(0.5, 0.0) }, DVec3::ZERO, dvec3(1.0, 0.75, 0.5));
    open.surfaces.retain(|s| s.corners.double_area_vector().y <= 0.0);
    let lamp = rectangle(part(grey(0.0, 200.0)), dvec3(0.6, 0.9, 0.1), DVec3::X * 0.3, DVec3::Z * 0.2);
    let scene = scene(laid_out(joined([open, lamp]), ways), &[placement]);
    let atlas = Atlas::new(&scene, Some(0.1 * scene.instances[0].scale())).expect("an atlas");
    assert!(atlas.layouts[0].border > 0, "the layout is kept: {:?}", atlas.notes);
    let map = lightmap(&scene, &atlas, &lit_scene(&scene, &mesh()), 0.0);
    let of_tile = |(number, tile): (usize, &Tile)| {
        let corners = atlas.chart_of(tile).0.sides[0].corners;
        lookup(&map, number, 0, point_of(corners.as_slice(), 0.4, 0.3))[0]
    };
    map.tiles.iter().enumerate().map(of_tile).collect()
}

/// Each way that an island can lie, and a mix of them, in each place.
#[test]
fn light_is_where_it_belongs_whichever_way_islands_lie() {
    let expected = light_in_open_box(&[0], DAffine3::IDENTITY);
    let most = expected.iter().copied().fold(0.0, f64::max);
    assert!(most > 1.0, "{expected:?}");
    for (number, placement) in places().into_iter().enumerate() {
        let ways: [&[usize]; 2] = [&[2 * number], &[4, 1 + number, 6, 0, 3, 5 + number]];
        for ways in ways {
            let found = light_in_open_box(ways, placement);
            assert_eq!(found.len(), expected.len());
            for (found, expected) in found.iter().zip(&expected) {
                // What texels between those that are gathered may be off by, twice: their squares lie the other way round.
                assert!((found - expected).abs() < 0.02 * most, "{ways:?}: {found}, expected {expected}");
            }
        }
    }
}

/// A floor as most tools unwrap it, so that a picture on it could be read: through files.
#[test]
fn a_readable_floor_under_an_even_sky_is_even() {
    let mut floor = rectangle(part(grey(0.5, 0.0)), DVec3::ZERO, DVec3::Z * 4.0, DVec3::X * 4.0);
    for surface in &mut floor.surfaces {
        let corners = surface.corners.as_slice();
        surface.lightmap = Some([0, 1, 2, 3].map(|i| 0.05 + 0.9 * dvec2(corners[i].x, corners[i].z) / 4.0));
    }
    let workshop = Workshop::new();
    Model::of(&[Node::new("floor", floor)]).write(&workshop.path("scene.glb"));
    let mut job = workshop.job(Division::Authored);
    job.outputs.lightmaps = Some(LightmapOptions { texel_size: Some(0.05), ..LightmapOptions::default() });
    job.settings.sky = Some(equilux_assemble::gather::sky::Sky::Uniform(Rgb([1.0; 3])));
    job.outputs.pictures = Pictures::None;
    let report = assembled(&job);
    assert!(!report.notes.iter().any(|note| note.contains("TEXCOORD_1")), "kept: {:?}", report.notes);
    let (_, texels) = super::files::texels(&workshop.path("out/scene/lightmap.exr"));
    let lit = texels.iter().filter(|texel| texel[0] > 0.0).count();
    let even = texels.iter().filter(|texel| (f64::from(texel[0]) / PI - 1.0).abs() < 1e-3).count();
    // Beyond the margin texels hold nothing; half floats.
    assert!(even == lit && lit * 5 > texels.len() * 4, "{even} of {lit} texels have π, of {}", texels.len());
}
