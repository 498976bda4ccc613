//! After a program is killed at any moment, the same command again produces the same files, byte for byte, and no others.

use super::{assert_same, contents, start};
use equilux_tests::rooms::furnished;
use equilux_tests::workshop::Workshop;
use std::time::{Duration, Instant};

/// Moments for each program; more of them with EQUILUX_KILLS.
const MOMENTS: u32 = 6;

const SCENE: [&str; 5] = ["scene.glb", "--element-size", "0.5", "--cache", "made/cache"];

#[test]
fn a_killed_bake_costs_nothing_but_time() {
    killed_and_run_again("bake", &SCENE);
}

#[test]
fn a_killed_assemble_costs_nothing_but_time() {
    let outputs = ["--rounds", "3", "--out", "made/out", "--elements", "made/table.csv"];
    killed_and_run_again("assemble", &[&SCENE[..], &outputs].concat());
}

fn killed_and_run_again(program: &str, arguments: &[&str]) {
    let moments = std::env::var("EQUILUX_KILLS").ok().and_then(|n| n.parse().ok()).unwrap_or(MOMENTS);
    let workshop = workshop_for_one();
    finish(&workshop, program, &["--help"]);
    let begin = Instant::now();
    finish(&workshop, program, arguments);
    let whole = begin.elapsed();
    let undisturbed = contents(&workshop, "made");

    let mut litter = 0;
    for moment in 0..moments {
        let mut delay = whole * moment / moments + part_of(whole / moments, moment);
        let workshop = loop {
            let workshop = workshop_for_one();
            if killed_after(delay, &workshop, program, arguments) {
                break workshop;
            }
            // It was quicker than the first.
            delay /= 2;
        };
        litter += workshop.files("made").keys().filter(|p| p.extension().is_some_and(|e| e == "tmp")).count();
        finish(&workshop, program, arguments);
        let what = format!("{program}, killed after {delay:?} of {whole:?}");
        assert_same(&contents(&workshop, "made"), &undisturbed, &what);
    }
    println!("{program}: killed {moments} times within {whole:?}, {litter} files were left half-written");
}

fn workshop_for_one() -> Workshop {
    let workshop = Workshop::with(&furnished());
    std::fs::create_dir(workshop.path("made")).expect("a new folder");
    workshop
}

fn finish(workshop: &Workshop, program: &str, arguments: &[&str]) {
    let ended = workshop.run(program, arguments);
    assert_eq!(ended.code, Some(0), "{program}: {}", ended.stderr);
}

/// Whether the program was still at work when it was killed.
fn killed_after(delay: Duration, workshop: &Workshop, program: &str, arguments: &[&str]) -> bool {
    let mut running = start(workshop, program, arguments);
    std::thread::sleep(delay);
    running.kill().expect("a process to kill");
    !running.wait().expect("it has ended").success()
}

/// Some part of `whole`, the same in every run, and unlike the rhythm of the program: Weyl's sequence of the golden ratio.
fn part_of(whole: Duration, number: u32) -> Duration {
    whole.mul_f64((f64::from(number) * 0.618_033_988_749_895).fract())
}
