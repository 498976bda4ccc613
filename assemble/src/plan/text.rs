//! The plan for a person.

use super::{Plan, PlannedInstance, PlannedPart, Step};
use crate::report::text::{bytes, left_out_line};

/// So many places are named, more are counted.
const NAMED: usize = 4;

impl Plan {
    /// A line for each part, for places of which the same is to be said, and for what will be left out.
    pub fn text(&self) -> String {
        let mut lines = vec![format!(
            "{}: {} elements ({}; {}), {} parts in {} places; no form factor is computed now",
            self.scene,
            self.elements,
            self.element_size,
            self.resolution,
            self.parts.len(),
            self.instances.len()
        )];
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
            0..=NAMED => format!("coupling of {} {what}", names.join(", ")),
            count => format!("coupling of {count} places {what}"),
        };
        lines.into_iter().map(line).collect()
    }
}

/// What becomes of a part, in a line.
pub fn part_line(part: &PlannedPart) -> String {
    let places = if part.places == 1 { "1 place".into() } else { format!("{} places", part.places) };
    let light = part.light.as_ref().map_or(String::new(), |light| format!("; light {}", step(light)));
    format!(
        "part {}: {} elements in {places}, solved by {}; form factors {}{light}",
        part.name,
        part.elements,
        part.local_solver,
        step(&part.form_factors)
    )
}

/// What becomes of an instance's own form factors, if something stands inside it.
pub fn corrected_line(instance: &PlannedInstance) -> Option<String> {
    let corrected = instance.corrected.as_ref()?;
    let inside = instance.intruders.join(", ");
    Some(format!("inside {} is {inside}: its own form factors {}", instance.name, step(corrected)))
}

/// What is done, and why.
pub fn step(step: &Step) -> String {
    format!("{}: {}", step.how, step.reason)
}
