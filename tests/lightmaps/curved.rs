//! Texels of meshes that stand for smooth surfaces.

use super::by_rays::texels_of;
use super::scene;
use equilux_assemble::lightmap::Lightmap;
use equilux_assemble::lightmap::texels::Texels;
use equilux_bake::monitor::Monitor;
use equilux_formats::{LightKind, LightUnits, Part, PunctualLight, Rgb, Scene};
use equilux_tests::smooth::{smooth_ball, smooth_capsule, smooth_cylinder};
use glam::{DAffine3, DQuat, DVec3, dvec3};

/// Towards the sun.
const SUN: DVec3 = DVec3::new(0.48, 0.64, 0.6);

/// A part with the normal of the surface for which it stands, at a point of it.
struct Shape {
    name: &'static str,
    part: Part,
    normal: fn(DVec3) -> DVec3,
}

fn shapes() -> Vec<Shape> {
    let from_axis = |p: DVec3| dvec3(p.x, p.y, 0.0).normalize();
    let from_segment = |p: DVec3| (p - DVec3::Z * p.z.clamp(0.0, 0.5)).normalize();
    vec![
        Shape { name: "ball", part: smooth_ball(0.2, 2), normal: DVec3::normalize },
        Shape { name: "cylinder", part: smooth_cylinder(0.2, 0.5, 16), normal: from_axis },
        Shape { name: "capsule", part: smooth_capsule(0.2, 0.5, 16), normal: from_segment },
    ]
}

/// As it is, turned, and turned, mirrored and larger.
fn placements() -> [DAffine3; 3] {
    let turn = DQuat::from_scaled_axis(dvec3(0.4, 1.1, -0.7));
    let mirrored = dvec3(-1.5, 1.5, 1.5);
    [
        DAffine3::IDENTITY,
        DAffine3::from_quat(turn),
        DAffine3::from_scale_rotation_translation(mirrored, turn, DVec3::ONE),
    ]
}

/// The scene in parallel light of 1 W/m².
fn sunlit(part: Part, placement: DAffine3) -> Scene {
    let mut scene = scene(part, &[placement]);
    scene.lights.push(PunctualLight {
        name: "sun".into(),
        position: DVec3::ZERO,
        direction: -SUN,
        intensity: Rgb::WHITE,
        units: LightUnits::Radiometric,
        kind: LightKind::Directional,
        angle: 0.0,
    });
    scene
}

/// The root mean square difference between the light of texels and the mean of `expected` over each, from the point in the
/// part's coordinates and the normal of the flat side there; weighted by area.
fn difference(scene: &Scene, texel: f64, expected: impl Fn(DVec3, DVec3) -> f64) -> f64 {
    let folder = tempfile::tempdir().expect("a folder");
    let (atlas, light) = texels_of(scene, folder.path(), texel);
    let placement = scene.instances[0].placement;
    let (mut sum, mut whole) = (0.0, 0.0);
    for (tile, light) in atlas.tiles().iter().zip(&light) {
        let (chart, grid) = atlas.chart_of(tile);
        for texel in Texels::new(chart, grid, 0..tile.size[1], 0, DAffine3::IDENTITY).texels {
            let Some(found) = light[(texel.at[1] * tile.size[0] + texel.at[0]) as usize] else { continue };
            let mean: f64 = texel
                .footprints
                .iter()
                .map(|piece| {
                    let corners = piece.corners.as_slice();
                    let places = inside(corners);
                    let all: f64 = places.iter().map(|&p| expected(p, piece.normal)).sum();
                    piece.area * all / places.len() as f64
                })
                .sum();
            sum += texel.area() * (found[1] - mean / texel.area()).powi(2);
            whole += texel.area();
        }
    }
    assert!(whole > 0.0 && placement.is_finite());
    (sum / whole).sqrt()
}

/// Some points of a convex polygon, evenly: the middles of the triangles around its middle, each cut in 16.
fn inside(corners: &[DVec3]) -> Vec<DVec3> {
    let middle = corners.iter().sum::<DVec3>() / corners.len() as f64;
    let triangles = (0..corners.len()).map(|k| [middle, corners[k], corners[(k + 1) % corners.len()]]);
    let quarters = |[a, b, c]: [DVec3; 3]| {
        let (ab, bc, ca) = (a.midpoint(b), b.midpoint(c), c.midpoint(a));
        [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]
    };
    let small = triangles.flat_map(quarters).flat_map(quarters);
    small.map(|[a, b, c]| (a + b + c) / 3.0).collect()
}

/// A convex body alone in parallel light receives max(0, n·l), with the normal n of the smooth surface, and nothing besides: what
/// the mesh is made of neither shadows itself nor shows.
#[test]
fn smooth_convex_shapes_have_the_light_of_the_surface_that_they_stand_for() {
    for Shape { name, part, normal } in shapes() {
        for (number, placement) in placements().into_iter().enumerate() {
            let lit = |p: DVec3, _| {
                let n = placement.matrix3.inverse().transpose() * normal(p);
                n.normalize().dot(SUN).max(0.0)
            };
            for texel in [0.08, 0.03] {
                let off = difference(&sunlit(part.clone(), placement), texel, lit);
                // Interpolated normals are off by 0.002 on sides of 20°, the light at the edge of the shade is that of 128 rays,
                // and normals are constant over pieces of 0.1 rad: together a few thousandths. Flat sides are 0.05 off.
                assert!(off <= 0.01, "{name} {number}, texels of {texel} m: {off} of the sun's light");
            }
        }
    }
}

/// The same meshes with the normals of their faces.
#[test]
fn flat_sides_have_the_light_of_their_own_planes() {
    for Shape { name, part, .. } in shapes() {
        let mut scene = sunlit(part, placements()[2]);
        scene.flatten_normals();
        let across = placements()[2].matrix3.inverse().transpose();
        let off = difference(&scene, 0.08, |_, face| (across * face).normalize().dot(SUN).max(0.0));
        // Bodies are convex: each side is lit whole or not at all, but a texel of several sides looks at the sun from 16 places,
        // which are not shared out among them quite by area.
        assert!(off <= 0.02, "{name}: {off} of the sun's light");
    }
}

/// Between charts of flat sides light jumps, and stays as it is; of smooth ones it is closed.
#[test]
fn seams_are_closed_where_both_sides_mean_the_same_normal() {
    let by_face = |texels: &Texels| {
        let light = |texel: &equilux_assemble::lightmap::texels::Texel| {
            Rgb::splat(texel.footprints[0].normal.dot(SUN).max(0.0))
        };
        texels.texels.iter().map(light).collect::<Vec<_>>()
    };
    for (is_smooth, part) in [(true, smooth_cylinder(0.2, 0.5, 16)), (false, smooth_cylinder(0.2, 0.5, 16))] {
        let mut scene = scene(part, &[DAffine3::IDENTITY]);
        if !is_smooth {
            scene.flatten_normals();
        }
        let atlas = equilux_assemble::lightmap::atlas::Atlas::new(&scene, Some(0.02)).expect("an atlas");
        let lightmap = Lightmap::new(&scene, &atlas, by_face, &Monitor::default()).expect("not stopped");
        let mut changed = 0.0_f64;
        for (tile, light) in lightmap.tiles.iter().zip(&lightmap.irradiance) {
            let (chart, grid) = atlas.chart_of(tile);
            let texels = Texels::new(chart, grid, 0..tile.size[1], 0, DAffine3::IDENTITY);
            for (texel, before) in texels.texels.iter().zip(by_face(&texels)) {
                let after = light[(texel.at[1] * tile.size[0] + texel.at[0]) as usize];
                changed = changed.max((after[0] - before[0]).abs());
            }
        }
        assert_eq!(changed > 1e-3, is_smooth, "light changed by {changed}, smooth: {is_smooth}");
        // Sides of 22.5° differ by less than their angle.
        assert!(changed <= 0.4, "light changed by {changed}, more than the jump");
    }
}
