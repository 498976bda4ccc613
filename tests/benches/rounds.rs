//! Rounds to a proved bound, by method: rooms in a row behind openings of any width, and furnished rooms cut by planes.
//! `cargo bench -p equilux-tests --bench rounds -- [corridor|cells] [PARTS…]`

use equilux_assemble::exchange::settings::Method;
use equilux_bake::treecode::Resolution;
use equilux_tests::assembled::Assembled;
use equilux_tests::corridors::{cells, corridor};
use std::time::Instant;

/// The bound to prove, relative to the brightest radiosity.
const ERROR: f64 = 1e-6;

/// The largest number of rounds.
const MOST: usize = 500;

const REFLECTANCES: [f64; 5] = [0.5, 0.9, 0.99, 0.999, 0.99999];

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).filter(|a| !a.starts_with("--")).collect();
    let counts: Vec<usize> = arguments.iter().filter_map(|a| a.parse().ok()).collect();
    let wanted = |what: &str| !arguments.iter().any(|a| a.parse::<usize>().is_err() && a != what);
    let counts = |default: &[usize]| if counts.is_empty() { default.to_vec() } else { counts.clone() };
    println!(
        "rounds to a proved {ERROR:e}, seconds, and the last bound over the true error where it was found"
    );
    println!(
        "{:<28}{:>9}{:>8}{:>16}{:>16}{:>16}{:>16}",
        "scene", "elements", "ρ", "jacobi", "gauss-seidel", "gmres", "auto"
    );
    let mut ratios = vec![];
    if wanted("corridor") {
        for opening in [0.25, 0.5, 1.0] {
            for rooms in counts(&[2, 8, 32, 64]) {
                let name = format!("{rooms} rooms, {opening} open");
                ratios.extend(table(&name, corridor(rooms, opening, 0.8, Resolution::for_tolerance(0.01))));
            }
        }
    }
    if wanted("cells") {
        for parts in counts(&[32]) {
            let scene = cells(6, parts, 0.55, Resolution::for_tolerance(0.01));
            ratios.extend(table(&format!("furnished, {parts} cells"), scene));
        }
    }
    let count = |holds: &dyn Fn(f64) -> bool| ratios.iter().filter(|&&ratio| holds(ratio)).count();
    println!(
        "{} bounds: {} below the true error, {} within 10 times of it, the least {:.3} times",
        ratios.len(),
        count(&|ratio| ratio < 1.0),
        count(&|ratio| (1.0..=10.0).contains(&ratio)),
        ratios.iter().copied().fold(f64::INFINITY, f64::min)
    );
}

/// Prints the lines of a scene; returns the last bounds over the true errors.
fn table(name: &str, mut scene: Assembled) -> Vec<f64> {
    let mut ratios = vec![];
    for reflectance in REFLECTANCES {
        scene.paint(reflectance);
        let elements: usize = scene.optics.iter().map(|optics| optics.emission.len()).sum();
        print!("{name:<28}{elements:>9}{reflectance:>8}");
        let exact = scene.exact();
        for method in [Method::Jacobi, Method::GaussSeidel, Method::Gmres, Method::Auto] {
            let start = Instant::now();
            let outcome = scene.exchange(method, ERROR, MOST);
            let seconds = start.elapsed().as_secs_f64();
            let pairs = outcome.radiosity.iter().flatten().zip(exact.iter().flatten());
            let off = pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            let rounds =
                if outcome.converged { outcome.rounds.len().to_string() } else { format!(">{MOST}") };
            let ratio = outcome.convergence.error_bound / off.max(f64::MIN_POSITIVE);
            print!("{:>16}", format!("{rounds} {seconds:.2} {ratio:.0}"));
            ratios.push(ratio);
        }
        println!();
    }
    ratios
}
