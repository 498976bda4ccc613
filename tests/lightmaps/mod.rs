//! Lightmaps: layout, light, and the models with lightmaps in viewers.

mod authored;
mod borders;
mod by_rays;
mod chosen;
mod curved;
pub mod files;
mod handed;
mod light;
mod places;
mod seams;
mod viewer;

use equilux_assemble::lightmap::Lightmap;
use equilux_assemble::lightmap::atlas::Tile;
use equilux_assemble::lightmap::texels::bilinear;
use equilux_formats::{Instance, Part, Rgb, Scene};
use equilux_tests::shapes::scene_of;
use glam::{DAffine3, DVec3};

/// A scene of one part in these places.
fn scene(part: Part, placements: &[DAffine3]) -> Scene {
    let mut scene = scene_of(vec![part]);
    let instance = |&placement: &DAffine3| Instance { placement, ..scene.instances[0].clone() };
    scene.instances = placements.iter().map(instance).collect();
    scene
}

/// What a bilinear lookup gives for a point of a tile's chart in one of its planes, in the coordinates of its part.
fn lookup(lightmap: &Lightmap, tile: usize, plane: usize, point: DVec3) -> Rgb {
    let Tile { size, .. } = lightmap.tiles[tile];
    let (_, grid) = lightmap.atlas.chart_of(&lightmap.tiles[tile]);
    let weights = bilinear(grid.texel_of(plane, point), size[0]);
    Rgb([0, 1, 2]
        .map(|channel: usize| weights.iter().map(|&(i, w)| w * lightmap.irradiance[tile][i][channel]).sum()))
}

/// A point of a convex polygon; `across` and `along` are in 0..1.
fn point_of(corners: &[DVec3], across: f64, along: f64) -> DVec3 {
    let (near, far) =
        (corners[0].lerp(corners[1], across), corners[corners.len() - 1].lerp(corners[2], across));
    near.lerp(far, along)
}
