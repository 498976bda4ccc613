//! Run time after an edit of a level, compared with a run from scratch: move a crate, switch a lamp, repaint a wall.
//! `cargo bench -p equilux-tests --bench edits -- [ROOMS] [ELEMENT SIZE] [TOLERANCE]`

use equilux_assemble::outputs::requests::Pictures;
use equilux_assemble::proof::sample::ExactRows;
use equilux_assemble::report::Report;
use equilux_assemble::run::job::Job;
use equilux_assemble::run::run;
use equilux_bake::elements::ElementSize;
use equilux_bake::geometry::aabb::Aabb;
use equilux_bake::monitor::Monitor;
use equilux_bake::oven::prepare::{Division, RowMethod};
use equilux_bake::treecode::{Resolution, rays_for_tolerance};
use equilux_formats::Rgb;
use equilux_tests::levels::furnished;
use equilux_tests::model::{Model, Node};
use equilux_tests::shapes::{grey, solid};
use equilux_tests::workshop::{Workshop, changed};
use glam::{DVec3, dvec3};
use std::time::Instant;

fn main() {
    let numbers: Vec<f64> = std::env::args().skip(1).filter_map(|a| a.parse().ok()).collect();
    let number = |k: usize, default: f64| numbers.get(k).copied().unwrap_or(default);
    let (rooms, size, tolerance) = (number(0, 32.0) as usize, number(1, 0.3), number(2, 0.01));
    let workshop = Workshop::new();
    let mut job = workshop.job(Division::Authored);
    job.settings.preparation.element_size = Some(ElementSize::Metres(size));
    job.settings.preparation.resolution = Resolution::for_tolerance(tolerance);
    job.settings.preparation.rows = RowMethod::Auto;
    job.settings.preparation.rays = rays_for_tolerance(tolerance);
    job.settings.goal.error = 1e-6;
    job.outputs.exact_rows = Some(ExactRows::About(0));
    job.outputs.pictures = Pictures::None;
    job.settings.warm = true;
    println!(
        "{:<34}{:>10}{:>12}{:>14}{:>10}{:>8}{:>9}{:>9}",
        "", "elements", "rays", "form factors", "of all", "rounds", "seconds", "faster"
    );
    let mut level = level(rooms);
    let measured =
        |what: &str, level: &[Node], first: Option<f64>| assemble_and_print(what, level, &job, first);
    let first = measured("from scratch", &level, None);
    measured("again, nothing changed", &level, Some(first));
    level[rooms + 3].at += dvec3(0.25, 0.0, 0.125);
    measured("a crate moved", &level, Some(first));
    let lamp = |node: &mut Node, by: f64| {
        let part = node.part.as_mut().expect("a part");
        let shining = part.materials.iter_mut().filter(|material| material.emission != [0.0; 3]);
        shining.for_each(|material| material.emission = material.emission.map(|e| e * by));
    };
    lamp(&mut level[5], 0.0);
    measured("a lamp switched off", &level, Some(first));
    level[2].part.as_mut().expect("a part").materials[0].reflectance = Rgb([0.8, 0.3, 0.2]);
    measured("a wall repainted", &level, Some(first));
    let empty = Workshop::new();
    let from_scratch = changed(job.clone(), |job| job.settings.cache = empty.path("cache"));
    assemble_and_print("the same from scratch", &level, &from_scratch, None);
}

/// Assembles `level` as the scene of `job` and prints a line of the table. Returns the wall time, seconds; `first` is that of
/// the run to compare with.
fn assemble_and_print(what: &str, level: &[Node], job: &Job, first: Option<f64>) -> f64 {
    Model::of(level).write(&job.scene);
    let start = Instant::now();
    let report: Report = run(job, &Monitor::default()).unwrap_or_else(|error| panic!("{error}"));
    let seconds = start.elapsed().as_secs_f64();
    let stored: usize = report.parts.iter().map(|part| part.stored).sum();
    let all = report.form_factors_stored.max(stored);
    println!(
        "{what:<34}{:>10}{:>12}{:>14}{:>10}{:>8}{seconds:>9.2}{:>9}",
        report.elements,
        report.rays_traced,
        report.form_factors_computed,
        format!("{:.2} %", 100.0 * report.form_factors_computed as f64 / all as f64),
        report.rounds.len(),
        first.map_or(String::new(), |first| format!("{:.1} ×", first / seconds)),
    );
    if std::env::var_os("EQUILUX_TEXT").is_some() {
        println!("{}", report.details());
    }
    seconds
}

/// Furnished rooms with a crate in each.
fn level(rooms: usize) -> Vec<Node> {
    let rooms = furnished(rooms);
    let crates: Vec<Node> = (0..rooms.len())
        .map(|k| {
            let floor = Aabb::around(rooms[k].surfaces[0].corners.as_slice()).low;
            let at = floor + dvec3(2.2, 0.3, 0.4 + 0.05 * (k % 8) as f64);
            let solid = solid(grey(0.6, 0.0), DVec3::splat(-0.25), dvec3(0.25, 0.25, 0.25));
            Node { at, ..Node::new(&format!("crate {k}"), solid) }
        })
        .collect();
    let named = rooms.into_iter().map(|part| Node::new(&part.name.clone(), part));
    named.chain(crates).collect()
}
