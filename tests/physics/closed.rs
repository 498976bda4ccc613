//! Closed scenes: every row sums to one, whatever stands in the way, so a furnace is uniform.

use crate::workshop::{Workshop, assembled};
use equilux_bake::equilibrium::{LocalSystem, factorise};
use equilux_bake::gltf_import::import_scene;
use equilux_bake::prepare::Division;
use equilux_formats::{LocalSolver, Part, Rows};
use equilux_tests::model::Node;
use equilux_tests::shapes::{fine, grey, joined, moved, part, quad, room, self_block, solid};
use glam::{DAffine3, DQuat, DVec3, dvec3};
use proptest::prelude::*;

fn worst_defect(block: &Rows) -> f64 {
    (0..block.receivers()).map(|i| (block.row_sum(i) - 1.0).abs()).fold(0.0, f64::max)
}

fn cube(reflectance: f64) -> Part {
    room(grey(reflectance, 1.0), DVec3::ZERO, DVec3::ONE)
}

/// Solids inside the unit cube that touch nothing, turned any way.
fn furnished(boxes: &[(DVec3, f64)]) -> Part {
    let solids = boxes.iter().enumerate().map(|(k, &(axis, angle))| {
        let centre = dvec3(0.3 + 0.4 * (k % 2) as f64, 0.3 + 0.4 * (k / 2) as f64, 0.35 + 0.1 * k as f64);
        let turn = DAffine3::from_rotation_translation(DQuat::from_axis_angle(axis, angle), centre);
        moved(solid(grey(0.5, 1.0), DVec3::splat(-0.1), dvec3(0.1, 0.12, 0.08)), turn)
    });
    joined(solids.chain([cube(0.5)]))
}

#[test]
fn furnace_is_uniform() {
    let geometry = fine(&cube(0.5), 0.2);
    let block = self_block(&geometry);
    let n = geometry.elements.len();
    for rho in [0.5, 0.9, 0.999] {
        let (reflectance, emission) = (vec![[rho; 3]; n], vec![[1.0; 3]; n]);
        let factors = factorise(&block, &geometry.clusters, &reflectance, LocalSolver::Direct);
        let system =
            LocalSystem::new(&block, &geometry.clusters, &reflectance, LocalSolver::Direct, factors.as_ref());
        let expected = 1.0 / (1.0 - rho);
        for b in system.solve(&emission, &emission) {
            // The row sums' rounding, 1e-15, is multiplied by ρ/(1−ρ), a thousand at most.
            assert!((b[0] / expected - 1.0).abs() <= 1e-12, "ρ = {rho}: {} for {expected}", b[0]);
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(12))]
    #[test]
    fn rows_of_a_closed_scene_sum_to_one(
        turns in prop::collection::vec((-1f64..1., -1f64..1., 0.1f64..1., 0f64..6.), 1..4)
    ) {
        let boxes: Vec<_> = turns.iter().map(|&(x, y, z, a)| (dvec3(x, y, z).normalize(), a)).collect();
        let block = self_block(&fine(&furnished(&boxes), 0.25));
        // A row is the sum of some 300 clipped terms of 1e-16 each.
        prop_assert!(worst_defect(&block) <= 1e-12, "defect {}", worst_defect(&block));
    }
}

#[test]
fn a_furnished_furnace_is_uniform_with_every_local_solver() {
    let geometry = fine(&furnished(&[(DVec3::Z, 0.5), (dvec3(1., 1., 0.).normalize(), 1.0)]), 0.2);
    let block = self_block(&geometry);
    let n = geometry.elements.len();
    let (reflectance, emission) = (vec![[0.9; 3]; n], vec![[1.0; 3]; n]);
    use LocalSolver::*;
    for solver in [Direct, GaussSeidel, Progressive, Iterative] {
        let factors = factorise(&block, &geometry.clusters, &reflectance, solver);
        let solution = LocalSystem::new(&block, &geometry.clusters, &reflectance, solver, factors.as_ref())
            .solve(&emission, &emission);
        let worst = solution.iter().map(|b| (b[0] / 10.0 - 1.0).abs()).fold(0.0, f64::max);
        // Rounding of rows and residual, 1e-14, over 1 − ρ.
        assert!(worst <= 1e-12, "{solver:?}: off by {worst}");
    }
}

/// The form factors from the floor of the unit cube to its ceiling and to one wall, averaged over the floor's elements.
fn from_the_floor(size: f64) -> (f64, f64) {
    let geometry = fine(&cube(0.5), size);
    let block = self_block(&geometry);
    let normal = |i: usize| geometry.elements[i].normal;
    let floor: Vec<usize> = (0..geometry.elements.len()).filter(|&i| normal(i).z > 0.5).collect();
    let to = |side: DVec3| {
        let entries = floor.iter().flat_map(|&i| block.row(i));
        entries.filter(|&(j, _)| normal(j).dot(side) > 0.5).map(|(_, f)| f).sum::<f64>() / floor.len() as f64
    };
    (to(-DVec3::Z), to(DVec3::X))
}

#[test]
fn faces_of_a_cube_exchange_what_the_closed_form_says() {
    // The average over elements is the midpoint rule. To the ceiling the integrand is smooth, so its error is a series
    // in h², which Romberg's scheme takes away term by term; each column is a better extrapolation than the last.
    let levels = [4.0, 8.0, 16.0, 32.0].map(|n: f64| from_the_floor(1.0 / n));
    let mut column: Vec<f64> = levels.iter().map(|level| level.0).collect();
    for power in 1..4 {
        let factor = 4f64.powi(power);
        column = column.windows(2).map(|pair| (factor * pair[1] - pair[0]) / (factor - 1.0)).collect();
    }
    let opposite = column[0];
    assert!((opposite - 0.199824895698387).abs() < 1e-8, "opposite {opposite}");
    // A wall meets the floor, where the integrand is not smooth; but what misses the ceiling meets one of four walls.
    for (ceiling, wall) in levels {
        assert!((ceiling + 4.0 * wall - 1.0).abs() < 1e-12, "ceiling {ceiling}, wall {wall}");
    }
    let adjacent = (1.0 - opposite) / 4.0;
    assert!((adjacent - 0.200043776075403).abs() < 1e-8, "adjacent {adjacent}");
}

#[test]
fn a_sheet_without_thickness_lets_nothing_through() {
    // A two-sided sheet splits a sealed box; its edges meet the walls in T-junctions, for the walls' grids do not
    // know of it.
    let mut sheet = grey(0.5, 0.0);
    sheet.double_sided = true;
    let height = 0.437;
    let sheet = quad(
        part(sheet),
        [dvec3(0., 0., height), dvec3(1., 0., height), dvec3(1., 1., height), dvec3(0., 1., height)],
    );
    // The walls are cut at the sheet, as a modeller would who puts a floor into a tower.
    let lower = room(grey(0.5, 0.0), DVec3::ZERO, dvec3(1., 1., height));
    let upper = room(grey(0.5, 0.0), dvec3(0., 0., height), DVec3::ONE);
    let open = |mut part: Part, z: f64| {
        part.surfaces.retain(|s| !s.corners.as_slice().iter().all(|p| p.z == z));
        part
    };
    for size in [0.3, 0.17] {
        let geometry =
            fine(&joined([open(lower.clone(), height), open(upper.clone(), height), sheet.clone()]), size);
        let block = self_block(&geometry);
        let above = |i: usize| {
            let e = &geometry.elements[i];
            if e.centroid.z == height { e.normal.z > 0.0 } else { e.centroid.z > height }
        };
        for i in 0..geometry.elements.len() {
            for (j, value) in block.row(i) {
                assert!(above(i) == above(j), "{value} leaks from {j} to {i}");
            }
            let sum = block.row_sum(i);
            assert!((sum - 1.0).abs() < 1e-12, "row {i} sums to {sum}");
        }
    }
}

#[test]
fn coincident_faces_are_named_and_do_not_add_up() {
    let twice = joined([cube(0.5), cube(0.5)]);
    let workshop = Workshop::with(&[Node::new("box", Part { materials: vec![grey(0.5, 1.0); 2], ..twice })]);
    let report = assembled(&workshop.job(Division::Authored));
    assert!(report.notes.iter().any(|note| note.contains("6 duplicate faces")), "{:?}", report.notes);
    // One face of each pair is left: the box is closed and nothing is counted twice.
    assert!(report.row_sum_defect.max <= 1e-12, "row sums off by {}", report.row_sum_defect.max);
}

#[test]
fn far_from_the_origin_nothing_changes() {
    let block_at = |offset: DVec3| {
        let there = moved(cube(0.5), DAffine3::from_translation(offset));
        let workshop = Workshop::with(&[Node::new("box", there)]);
        let scene = import_scene(&workshop.path("scene.glb")).expect("a scene");
        self_block(&fine(&scene.parts[0], 0.25))
    };
    // Whole metres are exact in f32 a million metres away, and parts are taken back to their own origin.
    assert_eq!(block_at(dvec3(1e6, -2e6, 3e6)), block_at(DVec3::ZERO));
}
