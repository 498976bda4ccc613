//! Predicts the time and memory of a run from the runs that are complete.

use super::run::Run;
use super::setting::{Kind, Setting};
use equilux_bake::treecode::rays_for_tolerance;

/// The expected wall time of a run on `elements` elements, seconds: that of the most similar run, scaled by a power of the
/// number of elements. Zero if no run is complete.
pub fn forecast(setting: &Setting, elements: usize, done: &[Run]) -> f64 {
    let kind = setting.kind;
    let larger = |run: &Run| elements as f64 / run.facts.elements.max(1) as f64;
    let dearer = |run: &Run| effort(kind) / effort(run.setting.kind);
    let apart = |run: &Run| larger(run).ln().abs() + dearer(run).ln().abs();
    let nearest = |like: &dyn Fn(&Run) -> bool| {
        done.iter().filter(|run| like(run)).min_by(|a, b| apart(a).total_cmp(&apart(b)))
    };
    let grown = |run: &Run| run.wall * larger(run).powf(exponent(kind));
    if let Some(run) = nearest(&|run| family(run.setting.kind) == family(kind)) {
        return grown(run) * dearer(run);
    }
    let known = nearest(&|_| true);
    known.map_or(0.0, |run| grown(run) * (guess(kind) / guess(run.setting.kind)).max(1.0))
}

/// Bytes of the matrix of a run on `elements` elements; none if the run stores no whole matrix.
pub fn matrix_bytes(kind: Kind, elements: usize) -> Option<f64> {
    let pairs = (elements as f64).powi(2);
    match kind {
        Kind::Dense | Kind::Rays(_) => Some(8.0 * pairs),
        // Each entry is stored with its column.
        Kind::Verified { .. } => Some(24.0 * pairs),
        Kind::Parts { tolerance: 0.0 } => Some(12.0 * pairs),
        Kind::Parts { .. } | Kind::Progressive { .. } => None,
    }
}

/// Bytes of memory that are available now; none where the system does not report them.
pub fn memory_available() -> Option<f64> {
    let text = std::fs::read_to_string("/proc/meminfo").ok()?;
    let line = text.lines().find(|line| line.starts_with("MemAvailable:"))?;
    line.split_whitespace().nth(1)?.parse::<f64>().ok().map(|kilobytes| kilobytes * 1024.0)
}

/// Runs of the same family take the same time for the same effort and number of elements.
fn family(kind: Kind) -> u8 {
    match kind {
        Kind::Parts { tolerance: 0.0 } => 0,
        Kind::Parts { .. } => 1,
        Kind::Verified { .. } => 2,
        Kind::Dense => 3,
        Kind::Rays(_) => 4,
        Kind::Progressive { .. } => 5,
    }
}

/// The quantity that time is proportional to within a family: rays of a row, and as much as 1024 of them for the light at
/// points, which does not depend on them; rays of a pair; or shots, of which equally many halve the unshot light each time.
fn effort(kind: Kind) -> f64 {
    match kind {
        Kind::Parts { tolerance } if tolerance > 0.0 => f64::from(1024 + rays_for_tolerance(tolerance)),
        Kind::Rays(rays) => f64::from(rays),
        Kind::Progressive { unshot } => -unshot.ln(),
        _ => 1.0,
    }
}

/// The power of the number of elements that time grows with.
fn exponent(kind: Kind) -> f64 {
    match kind {
        Kind::Parts { tolerance } if tolerance > 0.0 => 1.0,
        Kind::Parts { .. } | Kind::Progressive { .. } => 1.7,
        Kind::Verified { .. } | Kind::Dense | Kind::Rays(_) => 2.0,
    }
}

/// The guessed cost of a kind, relative to the others, until a run of its family is complete.
fn guess(kind: Kind) -> f64 {
    match kind {
        Kind::Parts { tolerance } if tolerance > 0.0 => 1.0,
        Kind::Parts { .. } | Kind::Dense | Kind::Progressive { .. } => 4.0,
        Kind::Verified { .. } => 8.0,
        Kind::Rays(rays) => 4.0 * f64::from(rays),
    }
}
