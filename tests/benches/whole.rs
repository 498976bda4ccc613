//! Furnished levels from parts to light: processor time and memory of a run, the noise of its rows, and what two numbers of rays differ by.
//!
//! `cargo bench -p equilux-tests --bench whole -- ROOMS SIZE RAYS…`, such as `32 0.3 256 2048`: rooms, element size in metres, and
//! rays a row. Differences are from the last.

use equilux_assemble::SolveSettings;
use equilux_assemble::equation::environment::Environment;
use equilux_assemble::exchange::listener::Unobserved;
use equilux_assemble::proof::noise::noise;
use equilux_assemble::report::process::{cpu_seconds, peak_rss};
use equilux_assemble::solve::{Solved, solve_prepared};
use equilux_bake::elements::ElementSize;
use equilux_bake::monitor::Monitor;
use equilux_bake::oven::prepare::{RowMethod, prepare};
use equilux_formats::{Scene, Store};
use equilux_tests::levels::furnished;
use equilux_tests::shapes::scene_of;

fn main() {
    let numbers: Vec<f64> = std::env::args().skip(1).filter_map(|a| a.parse().ok()).collect();
    let [rooms, size, ref rays @ ..] = numbers[..] else {
        println!("usage: whole ROOMS SIZE RAYS…");
        return;
    };
    let scene = scene_of(furnished(rooms as usize));
    let solved: Vec<Solved> = rays.iter().map(|&rays| run(&scene, size, rays as u32)).collect();
    if let Some((reference, others)) = solved.split_last() {
        others.iter().for_each(|other| compare(other, reference));
    }
}

fn run(scene: &Scene, size: f64, rays: u32) -> Solved {
    let folder = tempfile::tempdir().expect("a folder");
    let mut settings = SolveSettings { cache: folder.path().into(), ..SolveSettings::default() };
    settings.preparation.element_size = Some(ElementSize::Metres(size));
    (settings.preparation.rows, settings.preparation.rays) = (RowMethod::Rays, rays);
    let before = cpu_seconds();
    let prepared = prepare(scene, &settings.preparation).expect("elements");
    let (elements, unknowns) = (prepared.elements(), prepared.unknowns());
    let store = Store::open(folder.path()).expect("a cache");
    let environment = Environment::read(None, None).expect("no sky");
    let solved =
        solve_prepared(scene, prepared, &environment, &settings, &store, &Monitor::default(), &Unobserved)
            .expect("light");
    let seconds = cpu_seconds().zip(before).map_or(0.0, |(after, before)| after - before);
    let energy = &solved.outcome.convergence.energy;
    let bytes = std::process::Command::new("du").arg("-sb").arg(folder.path()).output().expect("du");
    let bytes: f64 = String::from_utf8_lossy(&bytes.stdout).split('\t').next().unwrap().parse().unwrap();
    let noise = noise(&solved.equation, solved.radiosity(), &solved.irradiance).expect("rays");
    println!(
        "{elements} elements, {unknowns} unknowns, R = {rays}: {seconds:.2} CPU-s, peak {:.0} MB, cache {:.0} bytes a row; absorbed / \
         emitted {:.4}, noise {:.2} %, {} rounds",
        peak_rss().unwrap_or(0) as f64 / 1e6,
        bytes / unknowns as f64,
        energy.absorbed[0] / energy.emitted[0],
        100.0 * noise.whole.over_mean,
        solved.outcome.rounds.len(),
    );
    solved
}

fn compare(solved: &Solved, reference: &Solved) {
    let (mut square, mut shift, mut sum, mut area) = (0.0, 0.0, 0.0, 0.0);
    for ((element, a), b) in solved.elements().iter().zip(&solved.irradiance).zip(&reference.irradiance) {
        square += element.area * (a[0] - b[0]).powi(2);
        shift += element.area * (a[0] - b[0]);
        sum += element.area * b[0];
        area += element.area;
    }
    println!(
        "RMS {:.2} %, mean shift {:+.3} %",
        100.0 * (square / area).sqrt() / (sum / area),
        100.0 * shift / sum
    );
}
