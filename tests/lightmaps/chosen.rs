//! What authors choose for texels: their size, whether there are any, and the size of images.

use super::scene;
use equilux_assemble::lightmap::LightmapOptions;
use equilux_assemble::lightmap::atlas::{Atlas, Tile};
use equilux_formats::{Part, Scene, TexelChoice};
use equilux_tests::shapes::{grey, joined, part, rectangle, solid};
use glam::{DAffine3, DVec3};

/// A crate of 1 m, and one half as large.
fn crates() -> Scene {
    let half =
        DAffine3::from_scale_rotation_translation(DVec3::splat(0.5), glam::DQuat::IDENTITY, DVec3::X * 3.0);
    scene(solid(grey(0.5, 0.0), DVec3::ZERO, DVec3::ONE), &[DAffine3::IDENTITY, half])
}

/// Sides of the rectangles of an instance without margins, in texels.
fn sides(atlas: &Atlas, instance: usize) -> Vec<u32> {
    let own = atlas.tiles().into_iter().filter(|tile: &Tile| tile.instance == instance);
    own.flat_map(|tile| tile.size.map(|side| side - 7)).collect()
}

#[test]
fn texels_have_the_size_that_their_instance_or_surface_asks_for() {
    let mut scene = crates();
    scene.instances[1].texels.size = Some(0.05);
    let atlas = Atlas::new(&scene, Some(0.25)).expect("an atlas");
    assert_eq!((sides(&atlas, 0), sides(&atlas, 1)), (vec![4; 12], vec![10; 12]), "metres of the scene");
    scene.parts[0].surfaces[0].texels.size = Some(0.125);
    let atlas = Atlas::new(&scene, Some(0.25)).expect("an atlas");
    let mut found = sides(&atlas, 0);
    found.sort_unstable();
    assert_eq!(found, [vec![4; 10], vec![8; 2]].concat());
}

/// With sizes for all, the default for the rest has no part in it.
#[test]
fn the_default_size_leaves_room_for_what_authors_choose() {
    let mut scene = crates();
    scene.instances[0].texels.size = Some(0.01);
    let atlas = Atlas::new(&scene, None).expect("an atlas");
    let texels: f64 = atlas.images.iter().map(|[w, h]| f64::from(*w) * f64::from(*h)).sum();
    // As for the default size alone: packing wastes a tenth more or less than assumed, and the size has two digits.
    assert!((0.75..1.25).contains(&(texels / f64::from(1 << 20))), "{:?}", atlas.images);
}

#[test]
fn what_gets_no_texels_has_no_place_in_any_image() {
    let mut scene = crates();
    scene.instances[0].texels.any = Some(false);
    let atlas = Atlas::new(&scene, Some(0.25)).expect("an atlas");
    assert_eq!((sides(&atlas, 0).len(), sides(&atlas, 1).len()), (0, 12));
    assert_eq!(atlas.layout_of(0).without_texels.len(), 6, "they are still known, to stand on seams");
    // A surface decides for itself.
    scene.parts[0].surfaces[2].texels.any = Some(true);
    let atlas = Atlas::new(&scene, Some(0.25)).expect("an atlas");
    assert_eq!((sides(&atlas, 0).len(), sides(&atlas, 1).len()), (2, 12));
}

/// In one plane, a floor of coarse and fine texels is two charts.
#[test]
fn a_chart_has_texels_of_one_size() {
    let tile = |x: f64| rectangle(part(grey(0.5, 0.0)), DVec3::X * x, DVec3::X, DVec3::Y);
    let both: Part = joined([tile(0.0), tile(1.0)]);
    let mut floor = Part { materials: both.materials[..1].to_vec(), ..both.clone() };
    floor.surfaces.iter_mut().for_each(|surface| surface.material = both.surfaces[0].material);
    let charts = |floor: &Part| equilux_assemble::lightmap::chart::charts(floor).len();
    assert_eq!(charts(&floor), 1);
    floor.surfaces[1].texels = TexelChoice { size: Some(0.1), any: None };
    assert_eq!(charts(&floor), 2);
}

#[test]
fn images_are_no_larger_than_asked_for_and_whole_blocks() {
    let scene = crates();
    for atlas_size in [256, 64] {
        let options = LightmapOptions { texel_size: Some(0.02), atlas_size, ..LightmapOptions::default() };
        let atlas = Atlas::of(&scene, &options).expect("an atlas");
        let total: usize = atlas.tiles().iter().map(Tile::texels).sum();
        assert!(atlas.images.len() * (atlas_size * atlas_size) as usize >= total, "{:?}", atlas.images);
        assert!(atlas.images.len() > 1 || atlas_size == 256, "{:?}", atlas.images);
        assert!(
            atlas.images.iter().flatten().all(|&side| side <= atlas_size && side % 4 == 0),
            "{:?}",
            atlas.images
        );
    }
    let options = LightmapOptions { texel_size: Some(0.01), atlas_size: 64, ..LightmapOptions::default() };
    let refused = Atlas::of(&scene, &options).expect_err("100 texels a side").to_string();
    assert!(
        ["part", "64 × 64", "texel_size", "--atlas-size"].iter().all(|word| refused.contains(word)),
        "{refused}"
    );
}
