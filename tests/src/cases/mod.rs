//! Scenes and views whose light is known: by closed forms, symmetry, or because light is neither made nor lost. Each is
//! a [`Case`]; the binary `stability` prints them as a table, and the suite runs the same ones.

pub mod finding;
pub mod form_factors;
pub mod furnaces;
pub mod point;
pub mod rooms;
pub mod scales;
pub mod solve;
pub mod spheres;
pub mod splits;
pub mod stiff;
pub mod untidy;
pub mod visibility;

pub use finding::Finding;

use std::any::Any;

/// A claim with its tolerance and its test.
#[derive(Debug, Clone, Copy)]
pub struct Case {
    /// The claim.
    pub name: &'static str,
    /// The largest error of the finding.
    pub tolerance: f64,
    /// The reason for the tolerance.
    pub why: &'static str,
    /// The largest number of rounds, if that is part of the claim.
    pub most_rounds: Option<usize>,
    /// Computes the finding.
    pub run: fn() -> Finding,
}

/// Cases about one subject.
#[derive(Debug)]
pub struct Theme {
    /// The subject.
    pub name: &'static str,
    /// The claims.
    pub cases: Vec<Case>,
}

/// All themes.
pub fn themes() -> Vec<Theme> {
    let theme = |name, cases| Theme { name, cases };
    vec![
        theme("form_factors", form_factors::cases()),
        theme("visibility", visibility::cases()),
        theme("furnaces", furnaces::cases()),
        theme("spheres", spheres::cases()),
        theme("rooms", rooms::cases()),
        theme("scales", scales::cases()),
        theme("splits", splits::cases()),
        theme("stiff", stiff::cases()),
        theme("untidy", untidy::cases()),
    ]
}

/// All cases, theme after theme.
pub fn all() -> Vec<Case> {
    themes().into_iter().flat_map(|theme| theme.cases).collect()
}

impl Case {
    /// A claim without a limit on rounds.
    pub fn new(name: &'static str, tolerance: f64, why: &'static str, run: fn() -> Finding) -> Self {
        Self { name, tolerance, why, most_rounds: None, run }
    }

    /// The same claim within at most `rounds` rounds.
    pub fn within(self, most_rounds: usize) -> Self {
        Self { most_rounds: Some(most_rounds), ..self }
    }

    /// Runs it. A panic is a finding too.
    pub fn found(&self) -> Finding {
        let panicked = |cause: Box<dyn Any + Send>| {
            let text = cause.downcast_ref::<String>().map(String::as_str);
            let text = text.or_else(|| cause.downcast_ref::<&str>().copied()).unwrap_or("a panic");
            Finding::of("no panic", text, f64::INFINITY)
        };
        std::panic::catch_unwind(self.run).unwrap_or_else(panicked)
    }

    /// Whether the finding supports the claim.
    pub fn holds(&self, finding: &Finding) -> bool {
        let in_time = match (self.most_rounds, finding.rounds) {
            (Some(most), Some(rounds)) => rounds <= most,
            (Some(_), None) => false,
            (None, _) => true,
        };
        finding.error <= self.tolerance && in_time
    }
}
