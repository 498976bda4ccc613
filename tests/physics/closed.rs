//! Closed scenes: every row sums to one, whatever stands in the way, so a furnace is uniform.

use equilux_bake::equilibrium::{LocalSystem, factorise};
use equilux_formats::{LocalSolver, Part, Rows};
use equilux_tests::shapes::{fine, grey, joined, mesh, moved, part, quad, room, self_block, solid};
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

/// The form factor between whole faces of the unit cube, averaged over the receiver by the midpoint rule at two sizes
/// and extrapolated: the rule errs by h² + h⁴.
fn averaged(of: impl Fn(DVec3) -> bool) -> f64 {
    let at = |size: f64| {
        let geometry = fine(&cube(0.5), size);
        let block = self_block(&geometry);
        let on_floor = |i: usize| geometry.elements[i].normal.z > 0.5;
        let floor: Vec<usize> = (0..geometry.elements.len()).filter(|&i| on_floor(i)).collect();
        let total: f64 = floor
            .iter()
            .flat_map(|&i| block.row(i).filter(|&(j, _)| of(geometry.elements[j].normal)).map(|(_, f)| f))
            .sum();
        total / floor.len() as f64
    };
    let (a, b, c) = (at(0.2), at(0.1), at(0.05));
    let (ab, bc) = ((4.0 * b - a) / 3.0, (4.0 * c - b) / 3.0);
    (16.0 * bc - ab) / 15.0
}

#[test]
fn faces_of_a_cube_exchange_what_the_closed_form_says() {
    let opposite = averaged(|normal| normal.z < -0.5);
    // Smooth integrand: three levels of extrapolation leave a few 1e-8.
    assert!((opposite - 0.199824895698387).abs() < 1e-7, "opposite {opposite}");
    let adjacent = averaged(|normal| normal.x > 0.5);
    assert!((opposite + 4.0 * adjacent - 1.0).abs() < 1e-7, "adjacent {adjacent}");
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
fn coincident_faces_do_not_add_up() {
    let geometry = mesh(&joined([cube(0.5), room(grey(0.9, 0.0), DVec3::ZERO, DVec3::ONE)]));
    let block = self_block(&geometry);
    for i in 0..block.receivers() {
        // Neither of two faces in the same place is before the other: both are seen, and light is counted twice.
        // The importer drops and names such faces; what must hold here is that nothing is worse than twice.
        let sum = block.row_sum(i);
        assert!(sum <= 2.0 + 1e-12, "row {i} sums to {sum}");
    }
}

#[test]
fn far_from_the_origin_nothing_changes() {
    let near = fine(&cube(0.5), 0.25);
    let mut far = near.clone();
    let offset = dvec3(1e6, -2e6, 3e6);
    for element in &mut far.elements {
        element.corners = element.corners.map(|p| p + offset - offset);
    }
    assert_eq!(self_block(&near), self_block(&far), "quarters of a metre are exact a million metres away");
}
