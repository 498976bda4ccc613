//! Separates errors by their source. Discretisation: the error of an exact run, because of the size of its elements.
//! Compression: the difference of a run with clusters from the exact run on the same elements. Iteration: the difference of an
//! exchange that ends early from one that does not.

use super::errors::Errors;
use super::reference::Reference;
use super::run::Run;
use super::setting::{DEFAULT_TOLERANCE, Kind, Setting};
use serde::Serialize;

/// The error of one choice from one source.
#[derive(Debug, Clone, Serialize)]
pub struct Separated {
    /// The source.
    pub from: Source,
    /// The choice: `0.25 m`, `tolerance 0.01 at 0.25 m`.
    pub choice: String,
    /// Number of elements.
    pub elements: usize,
    /// The errors, as shares of the mean.
    pub errors: Errors,
}

/// The source of an error.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Source {
    /// The size of elements.
    Discretisation,
    /// Clusters of elements with one form factor.
    Compression,
    /// An exchange that ends early.
    Iteration,
}

/// The separated errors of all runs that have a run to compare with.
pub fn separated(runs: &[Run], reference: &Reference) -> Vec<Separated> {
    let mut found = vec![];
    for exact in runs.iter().filter(|run| is_plain(&run.setting) && tolerance(run) == Some(0.0)) {
        found.push(Separated {
            from: Source::Discretisation,
            choice: format!("{} m", exact.setting.element_size),
            elements: exact.facts.elements,
            errors: Errors::of(&exact.light, reference),
        });
    }
    for run in runs.iter().filter(|run| is_plain(&run.setting)) {
        let Some(tolerance) = tolerance(run).filter(|&tolerance| tolerance > 0.0) else { continue };
        let exact = Setting::new(Kind::Parts { tolerance: 0.0 }, run.setting.element_size);
        found.extend(against(run, runs, &exact, reference).map(|errors| Separated {
            from: Source::Compression,
            choice: format!("tolerance {tolerance} at {} m", run.setting.element_size),
            elements: run.facts.elements,
            errors,
        }));
    }
    for run in runs.iter().filter(|run| run.setting.more.first().is_some_and(|option| option == "--error")) {
        let whole = Setting::new(Kind::Parts { tolerance: DEFAULT_TOLERANCE }, run.setting.element_size);
        found.extend(against(run, runs, &whole, reference).map(|errors| Separated {
            from: Source::Iteration,
            choice: format!(
                "ended at a proved {} after {} rounds",
                run.setting.more[1],
                run.facts.rounds.len()
            ),
            elements: run.facts.elements,
            errors,
        }));
    }
    found
}

fn against(run: &Run, runs: &[Run], other: &Setting, reference: &Reference) -> Option<Errors> {
    let other = runs.iter().find(|run| run.setting == *other)?;
    Some(Errors::between(&run.light, &other.light, &reference.areas))
}

fn is_plain(setting: &Setting) -> bool {
    setting.is_ours() && setting.more.is_empty()
}

fn tolerance(run: &Run) -> Option<f64> {
    match run.setting.kind {
        Kind::Parts { tolerance } => Some(tolerance),
        _ => None,
    }
}
