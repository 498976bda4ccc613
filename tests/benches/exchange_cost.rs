//! Cost of the exchange, by method: milliseconds a round for local equilibria, transfers, the coarse and the Krylov
//! space, and bounds; total milliseconds for setup and proof; and the total CPU time.
//!
//! `cargo bench -p equilux-tests --bench exchange_cost -- [rooms|cells|corridor] [SIZE…]`: element sizes in metres.
//! Equilibria are summed over threads; with RAYON_NUM_THREADS=1 all times are of one thread.

use equilux_assemble::exchange::outcome::Outcome;
use equilux_assemble::exchange::settings::Method;
use equilux_bake::treecode::Resolution;
use equilux_tests::assembled::Assembled;
use equilux_tests::corridors::{cells, corridor, level};
use std::fs::{self, DirEntry};
use std::sync::OnceLock;
use std::time::{Duration, Instant};

/// The bound to prove, relative to the brightest radiosity.
const ERROR: f64 = 1e-6;

/// The largest number of rounds.
const MOST: usize = 100;

/// Runs of a short exchange, of which the fastest is shown.
const RUNS: usize = 5;

/// Longer runs are not repeated.
const LONG: Duration = Duration::from_millis(600);

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).filter(|a| !a.starts_with("--")).collect();
    let wanted: Vec<&str> =
        arguments.iter().map(String::as_str).filter(|a| a.parse::<f64>().is_err()).collect();
    let sizes: Vec<f64> = arguments.iter().filter_map(|a| a.parse().ok()).collect();
    let is_wanted = |what: &str| wanted.is_empty() || wanted.contains(&what);
    println!("{:<62}{:^42}{:^36}", "", "ms a round", "ms in all");
    println!(
        "{:<30}{:>6} {:<13}{:>12}{:>10}{:>10}{:>14}{:>8}{:>9}{:>9}{:>9}{:>9}{:>11}",
        "scene",
        "ρ",
        "method",
        "rounds",
        "solve",
        "transfer",
        "coarse+Krylov",
        "judge",
        "account",
        "coarse",
        "bound",
        "prove",
        "whole"
    );
    let sizes = |default: &[f64]| if sizes.is_empty() { default.to_vec() } else { sizes.clone() };
    let resolution = Resolution::for_tolerance(0.01);
    if is_wanted("rooms") {
        for rooms in [6, 32] {
            for size in sizes(if rooms == 6 { &[0.26, 0.12] } else { &[0.7, 0.3] }) {
                table(&format!("{rooms} rooms"), &[0.7, 0.99], level(rooms, size, resolution));
            }
        }
    }
    if is_wanted("cells") {
        for size in sizes(&[0.3, 0.14]) {
            table("6 rooms, 32 cells", &[0.7, 0.99], cells(6, 32, size, resolution));
        }
    }
    if is_wanted("corridor") {
        for open in [0.25, 1.0] {
            for size in sizes(&[0.8, 0.25]) {
                let reflectances = [0.5, 0.7, 0.9, 0.99, 0.99999];
                table(
                    &format!("32 in a row, {open} open"),
                    &reflectances,
                    corridor(32, open, size, resolution),
                );
            }
        }
    }
}

fn table(name: &str, reflectances: &[f64], mut scene: Assembled) {
    let elements: usize = scene.optics.iter().map(|optics| optics.emission.len()).sum();
    for &reflectance in reflectances {
        scene.paint(reflectance);
        for (method, called) in [
            (Method::Jacobi, "jacobi"),
            (Method::GaussSeidel, "gauss-seidel"),
            (Method::Gmres, "gmres"),
            (Method::Auto, "auto"),
        ] {
            let (whole, outcome) = fastest(&scene, method);
            print!("{:<30}{reflectance:>6} {called:<13}", format!("{name}, {elements} elements"));
            line(&outcome, whole);
        }
    }
}

/// The CPU time of the fastest run, and its result.
fn fastest(scene: &Assembled, method: Method) -> (Duration, Outcome) {
    let run = || {
        let start = processor_time();
        let outcome = scene.exchange(method, ERROR, MOST);
        (processor_time() - start, outcome)
    };
    let mut best = run();
    for _ in 1..RUNS {
        if best.0 < LONG {
            best = [best, run()].into_iter().min_by_key(|(whole, _)| *whole).expect("there are two");
        }
    }
    best
}

/// CPU time of this process, which does not depend on the load of the machine. Wall time if the system does not provide it.
fn processor_time() -> Duration {
    static START: OnceLock<Instant> = OnceLock::new();
    let of = |task: DirEntry| -> Option<u64> {
        let line = fs::read_to_string(task.path().join("schedstat")).ok()?;
        line.split_whitespace().next()?.parse().ok()
    };
    match fs::read_dir("/proc/self/task") {
        Ok(tasks) => Duration::from_nanos(tasks.flatten().filter_map(of).sum()),
        Err(_) => START.get_or_init(Instant::now).elapsed(),
    }
}

fn line(outcome: &Outcome, whole: Duration) {
    let ms = |time: Duration| time.as_secs_f64() * 1e3;
    let rounds = outcome.rounds.len();
    let a_round = |time: Duration| ms(time) / rounds as f64;
    let (times, over) = (&outcome.times, &outcome.times.overhead);
    let (solve, transfer) = (times.solve.iter().sum(), times.transfer.iter().sum());
    let number = if outcome.converged { rounds.to_string() } else { format!(">{MOST}") };
    println!(
        "{number:>12}{:>10.2}{:>10.2}{:>8.2} ({:>2.0} %){:>8.2}{:>9.1}{:>9.1}{:>9.1}{:>9.1}{:>11.1}",
        a_round(solve),
        a_round(transfer),
        a_round(over.krylov),
        100.0 * over.krylov.as_secs_f64() / (solve + transfer).as_secs_f64(),
        a_round(over.estimates),
        ms(over.account),
        ms(over.coarse),
        ms(over.margin),
        ms(over.proof),
        ms(whole),
    );
}
