//! The settings chosen for a target error, and the trials that led to them.

use serde::Serialize;

/// The chosen settings and the trials.
#[derive(Debug, Clone, Serialize)]
pub struct Advice {
    /// The target error of light at points of surfaces, root mean square relative to the mean, the worst channel.
    pub target: f64,
    /// Whether the estimate is below the target, with a safety factor.
    pub met: bool,
    /// Largest edge of elements, m.
    pub element_size: f64,
    /// The tolerance of form factors, from which the number of rays follows.
    pub tolerance: f64,
    /// The expected error at points, as in lightmaps and tables of points.
    pub estimated: f64,
    /// The expected error of one value for each element, as in pictures and models.
    pub estimated_of_elements: f64,
    /// The sizes that were tried, in order.
    pub tried: Vec<Trial>,
    /// Wall time of all trials.
    pub seconds: f64,
}

/// One size that was tried.
#[derive(Debug, Clone, Serialize)]
pub struct Trial {
    /// Largest edge of elements, m.
    pub element_size: f64,
    /// Number of elements.
    pub elements: usize,
    /// Change of the light at points since the previous size, root mean square relative to the mean; none for the
    /// first size.
    pub moved: Option<f64>,
    /// Wall time.
    pub seconds: f64,
}

impl Advice {
    /// The chosen settings as text.
    pub fn lines(&self) -> Vec<String> {
        let percent = |error: f64| format!("{:.2} %", 100.0 * error);
        let tried = |trial: &Trial| {
            let moved = trial.moved.map_or(String::new(), |moved| format!(", moved by {}", percent(moved)));
            format!("{} m ({} elements{moved}, {:.2} s)", trial.element_size, trial.elements, trial.seconds)
        };
        let tried: Vec<String> = self.tried.iter().map(tried).collect();
        let found = if self.met {
            format!("light at points is expected to be off by {}", percent(self.estimated))
        } else if self.estimated.is_finite() {
            format!("NOT reached: light at points is expected to be off by {}", percent(self.estimated))
        } else {
            "NOT reached: every part has its own fixed element size, so the error could not be estimated"
                .into()
        };
        vec![
            format!("target error: {} of the mean in RMS; {found}", percent(self.target)),
            format!(
                "with one value for each element, as in pictures: off by {}",
                percent(self.estimated_of_elements)
            ),
            format!("tried {}", tried.join("; ")),
            format!("chosen: --element-size {} --tolerance {}", self.element_size, self.tolerance),
        ]
    }
}
