//! Which receivers take part in the rounds. A receiver that is black in all channels sends the same whatever arrives, so
//! its irradiance is gathered once, when the light of all others is known. Receivers wait in whole groups of rows, which
//! lie in one face and mostly share a material.

use super::Node;
use equilux_formats::{Rgb, Rows};
use rayon::prelude::*;

/// The groups of rows of an instance's two blocks that take part.
pub struct Active {
    own: Vec<bool>,
    coupling: Vec<bool>,
}

impl Active {
    /// All groups with a receiver that is not black.
    pub fn of(node: &Node) -> Self {
        let reflects = |i: usize| node.optics.reflectance[i] != [0.0; 3];
        let of = |block: &Rows| -> Vec<bool> {
            (0..block.groups()).map(|group| block.receivers_of(group).any(reflects)).collect()
        };
        Self { own: of(node.self_block), coupling: of(node.coupling) }
    }

    /// All other groups.
    pub fn inactive(&self) -> Self {
        let inverse = |active: &[bool]| active.iter().map(|active| !active).collect();
        Self { own: inverse(&self.own), coupling: inverse(&self.coupling) }
    }

    /// Irradiance from the instance itself, W/m², of which the radiosity of its nodes is given; zero for those who wait.
    pub fn own_irradiance(&self, node: &Node, own: &[Rgb]) -> Vec<Rgb> {
        gather(node.self_block, &self.own, own)
    }

    /// Irradiance from all other instances, W/m², of which the radiosity of all nodes is given; zero for those who wait.
    pub fn coupled_irradiance(&self, node: &Node, all: &[Rgb]) -> Vec<Rgb> {
        gather(node.coupling, &self.coupling, all)
    }

    /// Number of rows of the coupling that wait.
    pub fn waiting(&self, node: &Node) -> usize {
        let waits = (0..self.coupling.len()).filter(|&group| !self.coupling[group]);
        waits.map(|group| node.coupling.receivers_of(group).len()).sum()
    }
}

fn gather(block: &Rows, active: &[bool], values: &[Rgb]) -> Vec<Rgb> {
    let of = |group: usize| {
        if active[group] {
            block.gather_group(group, values)
        } else {
            vec![[0.0; 3]; block.receivers_of(group).len()]
        }
    };
    (0..block.groups()).into_par_iter().flat_map_iter(of).collect()
}
