//! The settings that were chosen for a target error, and the trials that led to them.

use serde::Serialize;

/// What was chosen, and why.
#[derive(Debug, Clone, Serialize)]
pub struct Advice {
    /// The error asked for: of light at points of surfaces, root mean square over the mean, the worst channel.
    pub target: f64,
    /// Whether the estimate is as much below the target as caution asks for.
    pub met: bool,
    /// Largest edge of elements, m.
    pub element_size: f64,
    /// What clusters may do to the answer.
    pub tolerance: f64,
    /// The error expected at points, as lightmaps and tables of points have them.
    pub estimated: f64,
    /// The error expected where each element has one value, as pictures and models have them.
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
    /// How far light at points moved from the size before, root mean square over the mean; none of the first.
    pub moved: Option<f64>,
    /// Wall time.
    pub seconds: f64,
}

impl Advice {
    /// What was chosen, for a person.
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
            "NOT reached: every part says its own element size, so that nothing was learnt".into()
        };
        vec![
            format!("error asked for: {} of the mean in RMS; {found}", percent(self.target)),
            format!("with one value an element, as in pictures, by {}", percent(self.estimated_of_elements)),
            format!("tried {}", tried.join("; ")),
            format!("chosen: --element-size {} --tolerance {}", self.element_size, self.tolerance),
        ]
    }
}
