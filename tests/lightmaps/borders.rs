//! Texels whose borders fall on the edges of what stands in a scene: no texel holds a piece without area.

use super::scene;
use equilux_assemble::lightmap::atlas::Atlas;
use equilux_assemble::lightmap::texels::{Texel, Texels};
use equilux_bake::elements::ElementSize;
use equilux_bake::geometry::aabb::Aabb;
use equilux_bake::oven::prepare::{Division, Preparation, RowMethod};
use equilux_bake::treecode::EXACT;
use equilux_formats::texture::{Texture, TexturedTriangle, Textures, Wrap};
use equilux_formats::{Instance, Material, Part, PartId, Rgb, Scene};
use equilux_tests::lit::{lightmap, lit_scene};
use equilux_tests::shapes::{grey, part, quad, rectangle, solid, triangle};
use glam::{DAffine3, DQuat, DVec3, dvec2, dvec3};
use proptest::prelude::*;
use std::collections::BTreeMap;
use std::f64::consts::PI;
use std::sync::Arc;

/// Paints all of a part in one colour of a palette, a quarter of full reflectance.
fn painted(mut part: Part) -> Part {
    let palette =
        Texture { size: [2, 1], texels: vec![[255; 4], [255, 255, 255, 64]], wrap: [Wrap::Repeat; 2] };
    let textures = Textures { reflectance: Some(Arc::new(palette)), emission: None };
    part.materials = vec![Material { textures, ..grey(1.0, 0.0) }];
    let halves = part.surfaces.iter().flat_map(|surface| {
        let c = surface.corners.as_slice();
        [[c[0], c[1], c[2]], [c[0], c[2], c[3]]]
    });
    let of = |corners| TexturedTriangle {
        material: equilux_formats::MaterialId(0),
        corners,
        colours: [Rgb([1.0; 3]); 3],
        reflectance_at: Some([dvec2(0.75, 0.5); 3]),
        emission_at: None,
    };
    part.textured = halves.map(of).collect();
    part
}

/// A floor of so many steps a side with a crate of so many on it, that many steps from its corner.
fn crate_on_floor(step: f64, floor: u32, crate_: u32, at: [u32; 2]) -> Scene {
    let rounded = |x: f64| f64::from(x as f32);
    let length = |steps: u32| rounded(f64::from(steps) * step);
    let ground =
        rectangle(part(grey(0.5, 0.0)), DVec3::ZERO, DVec3::Z * length(floor), DVec3::X * length(floor));
    let low = dvec3(length(at[0]), 0.0, length(at[1]));
    let high = dvec3(length(at[0] + crate_), length(crate_), length(at[1] + crate_));
    let mut scene = scene(painted(ground), &[DAffine3::IDENTITY]);
    scene.parts.push(painted(solid(grey(0.5, 0.0), low, high)));
    scene.instances.push(Instance { part: PartId(1), name: "crate".into(), ..scene.instances[0].clone() });
    scene
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    #[test]
    fn texels_that_end_where_things_end_have_light_and_colour(
        step in prop::sample::select(vec![1.0, 0.1, 0.25, 0.3, 1.0 / 3.0, 0.7]),
        texel in prop::sample::select(vec![1.0, 2.0, 0.5, 0.25, 1.0 / 3.0]),
        (floor, crate_) in (4..16_u32, 1..3_u32),
        at in prop::array::uniform2(0.0..1.0_f64),
    ) {
        let at = at.map(|at| (at * f64::from(floor - crate_)) as u32);
        let scene = crate_on_floor(step, floor, crate_, at);
        let atlas = Atlas::new(&scene, Some(step * texel)).expect("an atlas");
        let wanted = Preparation {
            element_size: Some(ElementSize::Mesh), division: Division::Authored, resolution: EXACT, rows: RowMethod::Exact, rays: 256, local_solver: None,
        };
        let lit = lit_scene(&scene, &wanted);
        let map = lightmap(&scene, &atlas, &lit, 1.0);
        for (number, tile) in map.tiles.iter().enumerate() {
            let (chart, grid) = atlas.chart_of(tile);
            let placement = scene.instances[tile.instance].placement;
            let texels = Texels::new(chart, grid, 0..tile.size[1], tile.instance, placement);
            let area: f64 = texels.texels.iter().map(|texel| texel.area()).sum();
            let whole: f64 = chart.sides.iter().map(|side| side.area).sum();
            prop_assert!((area / whole - 1.0).abs() < 1e-8, "{} m² of footprints, {} m²", area, whole);
            for texel in &texels.texels {
                prop_assert!(texel.footprints.iter().all(|piece| piece.area > 0.0), "{:?} in {:?}", texel, tile);
                let index = (texel.at[1] * tile.size[0] + texel.at[0]) as usize;
                let h = map.irradiance[number][index][0];
                prop_assert!((0.0..=PI * (1.0 + 1e-6)).contains(&h), "{} W/m² in {:?} of {:?}", h, texel.at, tile);
                // Nothing stands above the crate.
                let top = tile.instance == 1 && chart.direction.y > 0.5;
                prop_assert!(!top || (h / PI - 1.0).abs() < 1e-6, "{} W/m² on the crate", h);
                let colour = map.radiosity(number, index)[0] / h;
                prop_assert!(h == 0.0 || (colour - 64.0 / 255.0).abs() < 1e-12, "{} in {:?} of {:?}", colour, texel.at, tile);
            }
        }
    }
}

/// A floor of whole steps, perhaps with its corner cut off, turned in space.
fn turned_floor(step: f64, [width, depth]: [u32; 2], corner: bool, turn: [f64; 3]) -> Part {
    let turn = DQuat::from_scaled_axis(DVec3::from_array(turn));
    let at = |x: f64, z: f64| turn * dvec3(x, 0.0, z) * step + dvec3(3.0, -1.0, 7.0) * step;
    let (x, z) = (f64::from(width), f64::from(depth));
    match corner {
        true => triangle(part(grey(0.5, 0.0)), [at(0.0, 0.0), at(0.0, z), at(x, 0.0)]),
        false => quad(part(grey(0.5, 0.0)), [at(0.0, 0.0), at(0.0, z), at(x, z), at(x, 0.0)]),
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(128))]

    /// Charts are worked on in bands of rows: each texel is in one of them, whole, and none is a sliver that rounding left.
    #[test]
    fn bands_of_rows_hold_what_the_chart_holds(
        step in prop::sample::select(vec![1.0, 0.1, 0.25, 0.3, 1.0 / 3.0]),
        texel in prop::sample::select(vec![1.0, 2.0, 0.5, 1.0 / 3.0]),
        size in prop::array::uniform2(1..300_u32),
        corner in any::<bool>(),
        turn in prop_oneof![Just([0.0; 3]), prop::array::uniform3(-3.0..3.0_f64)],
        band in 1..100_u32,
    ) {
        let scene = scene(turned_floor(step, size, corner, turn), &[DAffine3::IDENTITY]);
        let atlas = Atlas::new(&scene, Some(step * texel)).expect("an atlas");
        let tile = atlas.tiles()[0];
        let (chart, grid) = atlas.chart_of(&tile);
        let texels = |rows| Texels::new(chart, grid, rows, 0, DAffine3::IDENTITY).texels;
        let extent = |texel: &Texel| {
            let corners = texel.footprints.iter().flat_map(|piece| piece.corners.as_slice());
            Aabb::around(corners).diagonal()
        };
        let whole: BTreeMap<[u32; 2], f64> = texels(0..tile.size[1]).iter().map(|t| (t.at, t.area())).collect();
        let in_bands = (0..tile.size[1].div_ceil(band)).flat_map(|k| {
            let rows = k * band..((k + 1) * band).min(tile.size[1]);
            let texels = texels(rows.clone());
            assert!(texels.iter().all(|texel| rows.contains(&texel.at[1])), "a texel outside of rows {rows:?}");
            texels
        });
        let in_bands: BTreeMap<[u32; 2], [f64; 2]> = in_bands.map(|t| (t.at, [t.area(), extent(&t)])).collect();
        let square = (step * texel).powi(2);
        prop_assert_eq!(in_bands.len(), whole.len());
        for (at, [area, extent]) in in_bands {
            // Corners of a triangle may reach into a texel by little, but they are as wide as they are long; a strip that is left
            // by rounding is 1e-13 of a texel wide.
            prop_assert!(area > 1e-11 * extent.powi(2), "{} m² of {} m in {:?}", area, extent, at);
            prop_assert!((whole[&at] - area).abs() < 1e-9 * square, "{} m² of {} in {:?}", area, whole[&at], at);
        }
    }
}
