//! Which receivers take part in the rounds. A receiver that is black in all channels sends the same whatever arrives, so
//! its irradiance is gathered once, when the light of all others is known. Receivers wait in whole groups of rows, which
//! lie in one face and mostly share a material.

use crate::exchange::system::InstanceSystem;
use equilux_formats::{Rgb, Rows};
use rayon::prelude::*;

/// The groups of rows of an instance's two blocks that take part.
pub struct ActiveRows {
    own: Vec<bool>,
    coupling: Vec<bool>,
}

impl ActiveRows {
    /// All groups with a receiver that is not black.
    pub fn of(system: &InstanceSystem) -> Self {
        let reflects = |i: usize| system.optics.reflectance[i] != Rgb::BLACK;
        let of = |block: &Rows| -> Vec<bool> {
            (0..block.groups()).map(|group| block.receivers_of(group).any(reflects)).collect()
        };
        Self { own: of(system.self_block), coupling: of(system.coupling) }
    }

    /// All other groups.
    pub fn inactive(&self) -> Self {
        let inverse = |active: &[bool]| active.iter().map(|active| !active).collect();
        Self { own: inverse(&self.own), coupling: inverse(&self.coupling) }
    }

    /// Irradiance from the instance itself, W/m², of which the radiosity of its nodes is given; zero for those who wait.
    pub fn own_irradiance(&self, system: &InstanceSystem, own: &[Rgb]) -> Vec<Rgb> {
        gather(system.self_block, &self.own, own)
    }

    /// Irradiance from all other instances, W/m², of which the radiosity of all nodes is given; zero for those who wait.
    pub fn coupled_irradiance(&self, system: &InstanceSystem, all: &[Rgb]) -> Vec<Rgb> {
        gather(system.coupling, &self.coupling, all)
    }

    /// Number of rows of the coupling that wait.
    pub fn waiting(&self, system: &InstanceSystem) -> usize {
        let waits = (0..self.coupling.len()).filter(|&group| !self.coupling[group]);
        waits.map(|group| system.coupling.receivers_of(group).len()).sum()
    }
}

fn gather(block: &Rows, active: &[bool], values: &[Rgb]) -> Vec<Rgb> {
    let of = |group: usize| {
        if active[group] {
            block.gather_group(group, values)
        } else {
            vec![Rgb::BLACK; block.receivers_of(group).len()]
        }
    };
    (0..block.groups()).into_par_iter().flat_map_iter(of).collect()
}
