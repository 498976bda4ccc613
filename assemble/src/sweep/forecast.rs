//! How long a run will take, from those that are done.

use super::run::Run;
use super::setting::{Kind, Setting};

/// Seconds that a run on so many elements will take: those of the run that is most like it, by powers of the number of
/// elements. Zero if nothing is known.
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

/// Bytes that a run on so many elements will hold, where it holds a whole matrix; else none.
pub fn matrix_bytes(kind: Kind, elements: usize) -> Option<f64> {
    let pairs = (elements as f64).powi(2);
    match kind {
        Kind::Dense | Kind::Rays(_) => Some(8.0 * pairs),
        // Each entry with its column.
        Kind::Verified { .. } => Some(24.0 * pairs),
        Kind::Parts { tolerance: 0.0 } => Some(12.0 * pairs),
        Kind::Parts { .. } | Kind::Progressive { .. } => None,
    }
}

/// Bytes of memory that the system can give away now; none where it does not tell.
pub fn memory_available() -> Option<f64> {
    let text = std::fs::read_to_string("/proc/meminfo").ok()?;
    let line = text.lines().find(|line| line.starts_with("MemAvailable:"))?;
    line.split_whitespace().nth(1)?.parse::<f64>().ok().map(|kilobytes| kilobytes * 1024.0)
}

/// Runs of one family take alike long for the same effort.
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

/// What time is proportional to within a family: rays; shots, which halve what is unshot again and again.
fn effort(kind: Kind) -> f64 {
    match kind {
        Kind::Rays(rays) => f64::from(rays),
        Kind::Progressive { unshot } => -unshot.ln(),
        _ => 1.0,
    }
}

/// How time grows with the number of elements.
fn exponent(kind: Kind) -> f64 {
    match kind {
        Kind::Parts { tolerance } if tolerance > 0.0 => 1.3,
        Kind::Parts { .. } | Kind::Progressive { .. } => 1.7,
        Kind::Verified { .. } | Kind::Dense | Kind::Rays(_) => 2.0,
    }
}

/// A guess at what kinds cost, relative to each other, until there are runs of them.
fn guess(kind: Kind) -> f64 {
    match kind {
        Kind::Parts { tolerance } if tolerance > 0.0 => 1.0,
        Kind::Parts { .. } | Kind::Dense | Kind::Progressive { .. } => 4.0,
        Kind::Verified { .. } => 8.0,
        Kind::Rays(rays) => 4.0 * f64::from(rays),
    }
}
