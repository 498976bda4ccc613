//! Notes about an import that succeeds. Remarks about meshes, materials, nodes and files become sentences, one for each
//! distinct remark.

use std::collections::HashMap;

/// The number of subjects that a sentence names; the rest are counted.
const NAMED: usize = 3;

/// Remarks, in the order in which they were first made.
#[derive(Default)]
pub(super) struct Notes {
    remarks: Vec<(String, Vec<String>)>,
    index: HashMap<String, usize>,
}

impl Notes {
    /// Adds `remark` about `subject`.
    pub(super) fn add(&mut self, subject: impl Into<String>, remark: impl Into<String>) {
        let (subject, remark) = (subject.into(), remark.into());
        let at = *self.index.entry(remark.clone()).or_insert(self.remarks.len());
        if at == self.remarks.len() {
            self.remarks.push((remark, Vec::new()));
        }
        let subjects = &mut self.remarks[at].1;
        if subjects.last() != Some(&subject) {
            subjects.push(subject);
        }
    }

    /// One sentence a remark.
    pub(super) fn into_sentences(self) -> Vec<String> {
        self.remarks.into_iter().map(|(remark, subjects)| format!("{}: {remark}", list(&subjects))).collect()
    }
}

fn list(subjects: &[String]) -> String {
    let named = subjects.iter().take(NAMED).map(String::as_str).collect::<Vec<_>>().join(", ");
    match subjects.len().saturating_sub(NAMED) {
        0 => named,
        rest => format!("{named} and {rest} more"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_remark_is_one_sentence_however_many_it_is_about() {
        let mut notes = Notes::default();
        for subject in ["a", "a", "b", "c", "d", "e"] {
            notes.add(subject, "is blue");
        }
        notes.add("a", "is round");
        assert_eq!(notes.into_sentences(), ["a, b, c and 2 more: is blue", "a: is round"]);
    }
}
