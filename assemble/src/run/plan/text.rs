//! The plan as text.

use super::Plan;
use crate::report::fates::{corrected_line, part_line, step};
use crate::report::text::{bytes, counted, left_out_line};

/// Number of instances that are named; the rest are counted.
const MAX_NAMED: usize = 4;

impl Plan {
    /// A line for each part, for each group of instances with the same fate, and for the skipped work.
    pub fn text(&self) -> String {
        let mut lines = vec![format!(
            "{}: {} elements ({}; {}), {} in {}; no form factor is computed now",
            self.scene,
            self.elements,
            self.element_size,
            self.resolution,
            counted(self.parts.len(), "part"),
            counted(self.instances.len(), "place")
        )];
        lines.push(format!("rows: {}", self.rows));
        lines.extend(self.parts.iter().map(part_line));
        lines.extend(self.instances.iter().filter_map(corrected_line));
        lines.extend(self.coupling_lines());
        lines.extend(self.unseen.iter().map(|[a, b]| format!("{a} and {b} cannot see each other")));
        lines.push(format!("exchange: {}", self.exchange));
        lines.extend(left_out_line(&self.left_out));
        lines.push(format!("memory: the classic matrix would take {}", bytes(self.classic_matrix_bytes)));
        lines.extend(self.notes.iter().map(|note| format!("note: {note}")));
        lines.join("\n") + "\n"
    }

    fn coupling_lines(&self) -> Vec<String> {
        let mut lines: Vec<(String, Vec<&str>)> = Vec::new();
        for instance in &self.instances {
            let what = step(&instance.coupling);
            match lines.iter_mut().find(|(said, _)| *said == what) {
                Some((_, names)) => names.push(&instance.name),
                None => lines.push((what, vec![&instance.name])),
            }
        }
        let line = |(what, names): (String, Vec<&str>)| match names.len() {
            0..=MAX_NAMED => format!("coupling of {} {what}", names.join(", ")),
            count => format!("coupling of {count} places {what}"),
        };
        lines.into_iter().map(line).collect()
    }
}
