//! Receivers that take part in the rounds. A receiver that is black in all channels sends the same radiosity whatever
//! arrives, so its irradiance is gathered only once, from the final radiosities. Rows are skipped in whole groups,
//! since a group of rows lies in one face and usually shares a material.

use crate::exchange::system::InstanceSystem;
use equilux_formats::{Rgb, Rows};
use rayon::prelude::*;

/// The row groups of an instance's two blocks that take part in the rounds.
#[derive(Debug)]
pub struct ActiveRows {
    own: Vec<bool>,
    coupling: Vec<bool>,
}

impl ActiveRows {
    /// The groups that contain a receiver that is not black.
    pub fn of(system: &InstanceSystem) -> Self {
        let reflects = |i: usize| system.optics.reflectance[i] != Rgb::BLACK;
        let of = |block: &Rows| -> Vec<bool> {
            (0..block.groups()).map(|group| block.receivers_of(group).any(reflects)).collect()
        };
        Self { own: of(system.self_block), coupling: of(system.coupling) }
    }

    /// The groups that do not take part.
    pub fn inactive(&self) -> Self {
        let inverse = |active: &[bool]| active.iter().map(|active| !active).collect();
        Self { own: inverse(&self.own), coupling: inverse(&self.coupling) }
    }

    /// Irradiance from the instance itself, W/m². `own`: radiosity of the instance's nodes, W/m². Skipped rows get
    /// zero.
    pub fn own_irradiance(&self, system: &InstanceSystem, own: &[Rgb]) -> Vec<Rgb> {
        gather(system.self_block, &self.own, own)
    }

    /// Irradiance from all other instances, W/m². `all`: radiosity of all nodes of the scene, W/m². Skipped rows get
    /// zero.
    pub fn coupled_irradiance(&self, system: &InstanceSystem, all: &[Rgb]) -> Vec<Rgb> {
        gather(system.coupling, &self.coupling, all)
    }

    /// Number of rows of the coupling that are skipped.
    pub fn skipped(&self, system: &InstanceSystem) -> usize {
        let skipped_groups = (0..self.coupling.len()).filter(|&group| !self.coupling[group]);
        skipped_groups.map(|group| system.coupling.receivers_of(group).len()).sum()
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
