//! The solution of a whole scene, stored as the start of the next run.

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

/// An instance of a solution.
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
    /// The radiosity of the instance with this name and part; none if the solution has none.
    pub fn of(&self, name: &str, part: Key) -> Option<&Vec<Rgb>> {
        let place = self.instances.iter().position(|known| known.name == name && known.part == part)?;
        Some(&self.radiosity[place])
    }
}
