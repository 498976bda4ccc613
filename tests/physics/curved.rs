//! Curved meshes, which occlude by their silhouettes: every entry equals the one from clipping by every face.

use equilux_bake::form_factor::plain;
use equilux_bake::monitor::Monitor;
use equilux_bake::treecode::{Audience, EXACT, Request, Resolution, Timed, block};
use equilux_bake::world::World;
use equilux_formats::{Geometry, Part};
use equilux_tests::curved::{Triangle, sphere, torus};
use equilux_tests::shapes::{fine, grey, mesh, moved, part, room, triangle};
use glam::{DAffine3, DQuat, DVec3, dvec3};
use proptest::prelude::*;

/// A room of two metres around solids that are placed in it.
fn world(size: f64, solids: &[(Vec<Triangle>, DAffine3)]) -> World {
    let walls = fine(&room(grey(0.5, 0.0), DVec3::splat(-1.0), DVec3::ONE), size);
    let solids = solids.iter().map(|(triangles, placement)| {
        let whole: Part = triangles.iter().fold(part(grey(0.5, 0.0)), |part, t| triangle(part, *t));
        mesh(&moved(whole, *placement))
    });
    let all: Vec<Geometry> = std::iter::once(walls).chain(solids).collect();
    World::new(all.iter().map(|geometry| (geometry, DAffine3::IDENTITY)))
}

/// The rows of everything to everything.
fn rows(world: &World, resolution: Resolution) -> Vec<Timed> {
    let senders: Vec<usize> = (0..world.instances()).collect();
    let of = |receivers: usize| {
        let request = Request::new(world, Audience::Instance(receivers), &senders, resolution);
        block(&request, &Monitor::default()).expect("not stopped")
    };
    senders.iter().map(|&receivers| of(receivers)).collect()
}

fn worst_sum(rows: &[Timed]) -> f64 {
    rows.iter().flat_map(|timed| &timed.row_sums).map(|sum| (sum - 1.0).abs()).fold(0.0, f64::max)
}

/// Entries that differ from clipping by every face, of about `count` rows.
fn worst_entry(world: &World, rows: &[Timed], count: usize) -> f64 {
    let every = (world.elements.len() / count).max(1);
    let mut worst = 0.0f64;
    for (instance, timed) in rows.iter().enumerate() {
        let elements = world.elements_of(instance);
        for receiver in elements.clone().step_by(every) {
            let mut row = vec![0.0; world.nodes.len()];
            timed.block.row(receiver - elements.start).for_each(|(column, value)| row[column] = value);
            for (node, value) in row.into_iter().enumerate() {
                let Some(sender) = world.element_of(node) else { continue };
                worst = worst.max((value - plain::form_factor(world, receiver, sender)).abs());
            }
        }
    }
    worst
}

prop_compose! {
    /// Turned any way around a point near `centre`.
    fn placed(centre: DVec3)(
        axis in (0.1..1.0, -1.0..1.0, -1.0..1.0), angle in 0.0..6.0, by in prop::array::uniform3(-0.1..0.1)
    ) -> DAffine3 {
        let turn = DQuat::from_axis_angle(dvec3(axis.0, axis.1, axis.2).normalize(), angle);
        DAffine3::from_rotation_translation(turn, centre + DVec3::from(by))
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(4))]

    #[test]
    fn curved_meshes_hide_what_their_faces_hide(
        ring in placed(dvec3(-0.35, 0.0, 0.0)), ball in placed(dvec3(0.6, 0.6, 0.6))
    ) {
        // The torus is a mesh; the ball, a closed convex solid, stands for all that is none.
        let world = world(0.5, &[(torus((0.4, 0.15), 12, 6), ring), (sphere(0.2, 1), ball)]);
        prop_assert!((0..world.occluders().all.len() as u32).any(|o| world.occluders().mesh(o).is_some()));
        let exact = rows(&world, EXACT);
        // Both are exact, and differ by the rounding of some hundred pieces, 1e-16 each, a few of them ill-conditioned.
        let entry = worst_entry(&world, &exact, 24);
        prop_assert!(entry <= 1e-10, "an entry is off by {entry:e}");
        // A closed scene's light arrives in full, but for the rounding of some thousand pieces.
        let sum = worst_sum(&exact);
        prop_assert!(sum <= 1e-12, "a row sums to 1 within {sum:e}");
        // Rows end when less than 5e-6 is missing.
        let sum = worst_sum(&rows(&world, Resolution::for_tolerance(0.01)));
        prop_assert!(sum <= 1e-5, "at a tolerance a row sums to 1 within {sum:e}");
    }

    #[test]
    fn light_around_interlocked_tori_arrives_in_full(
        one in placed(DVec3::ZERO), angle in 1.3..1.8
    ) {
        let ring = torus((0.35, 0.08), 16, 8);
        let link = DAffine3::from_rotation_translation(DQuat::from_axis_angle(DVec3::X, angle), dvec3(0.35, 0.0, 0.0));
        let world = world(0.25, &[(ring.clone(), one), (ring, one * link)]);
        let sum = worst_sum(&rows(&world, EXACT));
        prop_assert!(sum <= 1e-12, "a row sums to 1 within {sum:e}");
    }
}
