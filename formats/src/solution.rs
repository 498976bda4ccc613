//! The light of a whole scene, kept so that the next run may start from it.

use crate::fingerprint::Key;
use crate::rgb::Rgb;
use serde::{Deserialize, Serialize};

/// The radiosity of a scene.
#[derive(Debug, Clone, PartialEq)]
pub struct Solution {
    /// The instances, in order.
    pub instances: Vec<SolvedInstance>,
    /// Radiosity B, W/m², linear RGB: one vector an instance, elements in their part's order.
    pub radiosity: Vec<Vec<Rgb>>,
}

/// What was solved.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct SolvedInstance {
    /// The instance's name.
    pub name: String,
    /// The key of its part's form factors.
    pub part: Key,
    /// Number of its elements.
    pub elements: usize,
}

impl Solution {
    /// The radiosity of an instance of this name and part; none if there was none.
    pub fn of(&self, name: &str, part: Key) -> Option<&Vec<Rgb>> {
        let place = self.instances.iter().position(|known| known.name == name && known.part == part)?;
        Some(&self.radiosity[place])
    }
}
