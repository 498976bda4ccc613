//! The solution does not depend on the method: with any exchange, local solver, division and start, results differ by
//! no more than their proved error bounds.

use equilux_assemble::exchange::exchange;
use equilux_assemble::exchange::listener::Unobserved;
use equilux_assemble::exchange::settings::{Goal, Method};
use equilux_bake::elements::bisect::bisect;
use equilux_bake::elements::{ElementSize, optics, subdivide};
use equilux_bake::monitor::Monitor;
use equilux_bake::treecode::EXACT;
use equilux_formats::{LocalSolver, Part, Rgb, Tints};
use equilux_tests::assembled::Assembled;
use equilux_tests::rooms::paint;
use equilux_tests::shapes::{joined, moved, room, solid};
use glam::{DAffine3, DQuat, DVec3, dvec3};
use proptest::prelude::*;

const METHODS: [Method; 4] = [Method::Auto, Method::Jacobi, Method::GaussSeidel, Method::Gmres];

const SOLVERS: [LocalSolver; 4] =
    [LocalSolver::Direct, LocalSolver::GaussSeidel, LocalSolver::Progressive, LocalSolver::Iterative];

/// The largest number of rounds of a method; its bound must hold nevertheless.
const ROUNDS: usize = 400;

prop_compose! {
    /// A room with turned boxes in it, some of which shine, all of colours of their own.
    fn scene()(
        walls in colour(),
        boxes in prop::collection::vec((colour(), 0.0..6.0, prop::array::uniform3(0.6..3.4), prop::option::of(-9i32..9)), 1..4)
    ) -> Part {
        let solids = boxes.into_iter().enumerate().map(|(k, (reflectance, angle, centre, power))| {
            let mut material = paint(reflectance);
            let light = power.map_or(f64::from(u8::from(k == 0)), |power| 10f64.powi(power));
            material.emission = Rgb([light, 0.5 * light, 0.0]);
            let turn = DQuat::from_axis_angle(dvec3(0.3, 0.8, -0.5).normalize(), angle);
            let place = DAffine3::from_rotation_translation(turn, DVec3::from(centre));
            moved(solid(material, DVec3::splat(-0.2), dvec3(0.2, 0.3, 0.25)), place)
        });
        joined(solids.chain([room(paint(walls), DVec3::ZERO, DVec3::splat(4.0))]))
    }
}

fn colour() -> impl Strategy<Value = [f64; 3]> {
    prop::array::uniform3(prop_oneof![Just(0.0), 0.1..0.9, Just(0.99), Just(0.999)])
}

fn assembled(scene: &Part, cells: usize, solver: LocalSolver) -> Assembled {
    let cells = bisect(subdivide(scene, ElementSize::Metres(1.0)), cells);
    let optics =
        cells.iter().map(|cell| optics(cell, &scene.materials, &Tints::plain(cell.elements.len()))).collect();
    Assembled::new(cells, optics, EXACT, Some(solver))
}

/// Largest difference in each channel.
fn difference(a: &[Rgb], b: &[Rgb]) -> Rgb {
    a.iter().zip(b).fold(Rgb::BLACK, |most, (&a, &b)| most.max((a - b).abs()))
}

fn brightest(light: &[Rgb]) -> Rgb {
    difference(light, &vec![Rgb::BLACK; light.len()])
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 12, max_shrink_iters: 0, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn no_way_of_solving_is_further_off_than_it_proves(
        scene in scene(), cells in 2usize..9, solver in prop::sample::select(&SOLVERS[..]), error in prop::sample::select(&[1e-2, 1e-4, 1e-8][..])
    ) {
        let parts = assembled(&scene, cells, solver);
        let exact = parts.exchange(Method::Gmres, 0.0, 4000);
        prop_assert!(exact.converged, "nothing to compare with");
        // The reference is itself only as good as rounding lets it be; a bound of a millionth of the requested one is enough.
        prop_assert!(exact.convergence.relative_bound < 1e-9, "reference within {:e}", exact.convergence.relative_bound);
        for method in METHODS {
            let systems = parts.systems();
            let goal = Goal { error, rounds: ROUNDS };
            let outcome = exchange(&systems, method, goal, None, &Monitor::default(), &Unobserved);
            let off = difference(&outcome.radiosity, &exact.radiosity);
            let (bound, most) = (outcome.convergence.relative_bound + exact.convergence.relative_bound, brightest(&exact.radiosity));
            for c in 0..3 {
                prop_assert!(
                    off[c] <= bound * (1.0 + bound) * most[c],
                    "{method:?}, channel {c}: off by {:e} of {:e}, proved {bound:e} of it", off[c], most[c]
                );
            }
            prop_assert!(
                !outcome.converged || outcome.convergence.relative_bound <= error,
                "{method:?} says it is within {error:e} and proves {:e}", outcome.convergence.relative_bound
            );
            let all_rounds = outcome.rounds.iter().filter_map(|round| Some((round, round.radiosity.as_ref()?)));
            for (round, light) in all_rounds {
                let off = difference(light, &exact.radiosity).into_iter().fold(0.0, f64::max);
                let bound = round.convergence.error_bound + exact.convergence.error_bound;
                prop_assert!(off <= bound, "{method:?}, round {}: off by {off:e}, proved {bound:e}", round.number);
                let energy = round.convergence.energy;
                for c in 0..3 {
                    let parts = [energy.absorbed[c], energy.escaped[c], energy.travelling[c]];
                    let (sum, size) = (parts.iter().sum::<f64>(), parts.iter().map(|p| p.abs()).sum::<f64>());
                    // A few hundred elements, each a sum of a few terms.
                    prop_assert!((sum - energy.emitted[c]).abs() <= 1e-12 * size, "{energy:?} does not add up");
                }
            }
            // What is proved already needs no round.
            let start: Vec<Vec<Rgb>> = parts.split(&outcome.radiosity);
            let again = exchange(&systems, method, Goal { error: 2.0 * outcome.convergence.relative_bound, rounds: ROUNDS }, Some(&start), &Monitor::default(), &Unobserved);
            prop_assert!(again.rounds.len() <= 1, "{method:?}: {} rounds from the solution", again.rounds.len());
        }
    }
}
