//! Cost of a live page for its run, and the rate of its updates. In pairs, the same furnished level from the cache:
//! once without, once with a viewer that fetches every light as soon as possible. `cargo bench -p equilux-tests --bench
//! live -- [ROOMS] [ELEMENT SIZE] [PAIRS] [TOLERANCE]` There is at most one light a round; a large tolerance makes
//! rounds fast.

use equilux_assemble::equation::observer::Observer;
use equilux_assemble::exchange::listener::{FinishedRound, Unobserved};
use equilux_assemble::exchange::outcome::Convergence;
use equilux_assemble::exchange::settings::Method;
use equilux_assemble::exchange::step_times::StepTimes;
use equilux_assemble::live::Live;
use equilux_assemble::outputs::requests::Pictures;
use equilux_assemble::proof::sample::ExactRows;
use equilux_assemble::report::Report;
use equilux_assemble::run::job::Job;
use equilux_assemble::run::run_observed;
use equilux_bake::elements::ElementSize;
use equilux_bake::monitor::Monitor;
use equilux_bake::oven::prepare::Division;
use equilux_bake::treecode::Resolution;
use equilux_formats::Rgb;
use equilux_tests::levels::furnished;
use equilux_tests::model::{Model, Node};
use equilux_tests::workshop::Workshop;
use std::io::{BufRead, BufReader, Read, Write};
use std::net::TcpStream;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::time::{Duration, Instant};

fn main() {
    let numbers: Vec<f64> = std::env::args().skip(1).filter_map(|a| a.parse().ok()).collect();
    let number = |k: usize, default: f64| numbers.get(k).copied().unwrap_or(default);
    let (rooms, size, pairs) = (number(0, 32.0) as usize, number(1, 0.19), number(2, 5.0) as usize);
    let workshop = Workshop::new();
    let nodes: Vec<Node> =
        furnished(rooms).into_iter().map(|part| Node::new(&part.name.clone(), part)).collect();
    Model::of(&nodes).write(&workshop.path("scene.glb"));
    let mut job = workshop.job(Division::Authored);
    job.settings.preparation.element_size = Some(ElementSize::Metres(size));
    job.settings.preparation.resolution = Resolution::for_tolerance(number(3, 0.3));
    // Many rounds, for many updates.
    (job.settings.method, job.settings.goal.error) = (Method::Jacobi, 1e-12);
    (job.outputs.exact_rows, job.outputs.pictures) = (Some(ExactRows::About(0)), Pictures::None);
    let first = measured(&job, false);
    println!("{} elements, {} rounds; from nothing {:.1} s", first.elements, first.rounds, first.seconds);
    println!("{:>24}{:>24}{:>24}", "run, s", "run, CPU-s", "exchange, a s");
    println!(
        "{:>12}{:>12}{:>12}{:>12}{:>12}{:>12}",
        "alone", "viewed", "alone", "viewed", "rounds", "lights"
    );
    let mut slower = Vec::new();
    let mut fast = (0.0, 0.0);
    for pair in 0..pairs {
        // The order of the pair alternates.
        let [alone, viewed] = if pair % 2 == 0 {
            [measured(&job, false), measured(&job, true)]
        } else {
            let viewed = measured(&job, true);
            [measured(&job, false), viewed]
        };
        println!(
            "{:>12.2}{:>12.2}{:>12.2}{:>12.2}{:>12.1}{:>12.1}",
            alone.seconds,
            viewed.seconds,
            alone.cpu,
            viewed.cpu,
            viewed.rounds as f64 / viewed.exchange,
            viewed.lights as f64 / viewed.exchange
        );
        fast = viewed.fast;
        slower.push((viewed.seconds / alone.seconds - 1.0, viewed.cpu / alone.cpu - 1.0));
    }
    let median = |of: fn(&(f64, f64)) -> f64| {
        let mut all: Vec<f64> = slower.iter().map(of).collect();
        all.sort_by(f64::total_cmp);
        100.0 * all[all.len() / 2]
    };
    println!(
        "median of {pairs} pairs: the run takes {:+.1} % longer; with server and viewer it takes {:+.1} % more CPU time",
        median(|pair| pair.0),
        median(|pair| pair.1)
    );
    println!(
        "rounds that take nothing: {:.1} lights a second; telling one takes {:.1} µs on average",
        fast.0, fast.1
    );
}

/// Times and counts of a run.
struct Measured {
    elements: usize,
    rounds: usize,
    /// Wall time of all.
    seconds: f64,
    /// Wall time of all rounds.
    exchange: f64,
    /// CPU time of this process.
    cpu: f64,
    /// Lights that the viewer received.
    lights: usize,
    /// For rounds without work: lights a second, and microseconds to publish one.
    fast: (f64, f64),
}

fn measured(job: &Job, is_viewed: bool) -> Measured {
    let monitor = Arc::new(Monitor::default());
    let live = is_viewed.then(|| Live::start(0, false, &monitor).expect("a page"));
    let (over, lights) = (Arc::new(AtomicBool::new(false)), Arc::new(AtomicUsize::new(0)));
    let viewer = live.as_ref().map(|live| {
        let (url, over, lights) = (live.url().to_owned(), Arc::clone(&over), Arc::clone(&lights));
        std::thread::spawn(move || view(&url, &over, &lights))
    });
    let (start, cpu) = (Instant::now(), cpu_seconds());
    let report: Report = run_observed(job, &monitor, live.as_ref().map_or(&Unobserved, Live::begin))
        .unwrap_or_else(|error| panic!("{error}"));
    let (seconds, cpu) = (start.elapsed().as_secs_f64(), cpu_seconds() - cpu);
    let got = lights.load(Ordering::Relaxed);
    let fast = live.as_ref().map_or((0.0, 0.0), |live| fast_rounds(live.begin(), &report, &lights));
    over.store(true, Ordering::Relaxed);
    if let Some(live) = &live {
        live.end(Ok(&report));
    }
    viewer.into_iter().for_each(|viewer| viewer.join().expect("the viewer"));
    Measured {
        elements: report.elements,
        rounds: report.rounds.len(),
        seconds,
        exchange: report.rounds.iter().map(|round| round.seconds).sum(),
        cpu,
        lights: got,
        fast,
    }
}

/// Publishes rounds of a placed scene as fast as possible.
fn fast_rounds(observer: &dyn Observer, report: &Report, lights: &AtomicUsize) -> (f64, f64) {
    let instances: Vec<usize> = (0..report.instances).collect();
    let (radiosity, times) = (vec![Rgb::WHITE; report.elements], StepTimes::none(report.instances));
    let (start, before, mut number) = (Instant::now(), lights.load(Ordering::Relaxed), 0);
    while start.elapsed() < Duration::from_secs(2) {
        number += 1;
        observer.round(&FinishedRound {
            instances: &instances,
            number,
            convergence: Convergence::default(),
            times: &times,
            is_last: false,
            radiosity: &radiosity,
        });
    }
    let seconds = start.elapsed().as_secs_f64();
    ((lights.load(Ordering::Relaxed) - before) as f64 / seconds, 1e6 * seconds / number as f64)
}

/// Fetches lights until the run is over.
fn view(url: &str, over: &AtomicBool, lights: &AtomicUsize) {
    let (host, path) = url.strip_prefix("http://").and_then(|rest| rest.split_once('/')).expect("an address");
    let mut stream = BufReader::new(TcpStream::connect(host).expect("the server"));
    let mut newest = 0;
    while !over.load(Ordering::Relaxed) {
        let request = format!("GET /{path}field/radiosity?after={newest} HTTP/1.1\r\nHost: {host}\r\n\r\n");
        stream.get_mut().write_all(request.as_bytes()).expect("the server reads");
        let (mut length, mut line) = (0, String::new());
        while line != "\r\n" {
            line.clear();
            stream.read_line(&mut line).expect("the server answers");
            if let Some(text) = line.to_lowercase().strip_prefix("content-length:") {
                length = text.trim().parse().expect("a length");
            }
        }
        let mut body = vec![0; length];
        stream.read_exact(&mut body).expect("a body");
        if let Some(number) = body.get(4..8) {
            newest = u32::from_le_bytes(number.try_into().expect("four bytes"));
            lights.fetch_add(1, Ordering::Relaxed);
        }
    }
}

/// CPU time of this process, user and system, in clock ticks of a hundredth of a second.
fn cpu_seconds() -> f64 {
    let text = std::fs::read_to_string("/proc/self/stat").expect("Linux");
    let fields: Vec<&str> = text.rsplit(") ").next().expect("fields").split(' ').collect();
    let ticks = |field: usize| fields[field].parse::<f64>().expect("a number");
    (ticks(11) + ticks(12)) / 100.0
}
