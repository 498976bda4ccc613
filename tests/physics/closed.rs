//! Closed scenes: every row sums to one, whatever the occluders.

use equilux_formats::{Part, Rows};
use equilux_tests::shapes::{fine, grey, joined, moved, room, self_block, solid};
use glam::{DAffine3, DQuat, DVec3, dvec3};
use proptest::prelude::*;

fn worst_defect(block: &Rows) -> f64 {
    (0..block.receivers()).map(|i| (block.row_sum(i) - 1.0).abs()).fold(0.0, f64::max)
}

/// Solids inside the unit cube that touch nothing, turned any way.
fn furnished(boxes: &[(DVec3, f64)]) -> Part {
    let solids = boxes.iter().enumerate().map(|(k, &(axis, angle))| {
        let centre = dvec3(0.3 + 0.4 * (k % 2) as f64, 0.3 + 0.4 * (k / 2) as f64, 0.35 + 0.1 * k as f64);
        let turn = DAffine3::from_rotation_translation(DQuat::from_axis_angle(axis, angle), centre);
        moved(solid(grey(0.5, 1.0), DVec3::splat(-0.1), dvec3(0.1, 0.12, 0.08)), turn)
    });
    joined(solids.chain([room(grey(0.5, 1.0), DVec3::ZERO, DVec3::ONE)]))
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
