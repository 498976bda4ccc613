//! Where errors come from. Elements of a size have an error even if everything else is exact (discretisation); clusters add
//! to it what a run differs by from the exact run on the same elements (compression); an exchange that ends early adds what
//! it differs by from one that does not (iteration).

use super::errors::Errors;
use super::reference::Reference;
use super::run::Run;
use super::setting::{DEFAULT_TOLERANCE, Kind, Setting};
use serde::Serialize;

/// One kind of error of one choice.
#[derive(Debug, Clone, Serialize)]
pub struct Separated {
    /// Where it comes from.
    pub from: Source,
    /// The choice: `0.25 m`, `tolerance 0.01 at 0.25 m`.
    pub choice: String,
    /// Number of elements.
    pub elements: usize,
    /// The errors, as shares of the mean.
    pub errors: Errors,
}

/// Where an error comes from.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Source {
    /// The size of elements.
    Discretisation,
    /// Clusters that share a form factor.
    Compression,
    /// An exchange that ends early.
    Iteration,
}

/// All that the runs tell.
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
