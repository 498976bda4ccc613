//! Groups of parts that exchange light. Input: the parts' couplings. Output: groups without light between them. Each
//! group is an equation of its own, with its own brightest radiosity and its own end of the rounds.

use crate::exchange::active_rows::ActiveRows;
use crate::exchange::system::InstanceSystem;
use equilux_bake::geometry::disjoint_sets::DisjointSets;
use equilux_formats::Rgb;
use rayon::prelude::*;
use std::ops::Range;

/// Parts that exchange light with each other and with no other part. Vectors of a group hold its members' elements, one
/// member after the other.
#[derive(Debug)]
pub struct Group<'a> {
    systems: &'a [InstanceSystem<'a>],
    /// The instances, in order.
    pub members: Vec<usize>,
    /// The range of each member's elements in a vector of the group.
    elements: Vec<Range<usize>>,
    /// The range of each member's senders among those of the whole scene.
    senders: Vec<Range<usize>>,
    /// For each member, the members that it receives light from.
    pub sees: Vec<Vec<usize>>,
    active: Vec<ActiveRows>,
    scene_senders: usize,
}

/// The groups of a scene; every instance is in one of them.
pub fn groups<'a>(systems: &'a [InstanceSystem<'a>]) -> Vec<Group<'a>> {
    let senders = ranges(systems.iter().map(|system| system.clusters.nodes()));
    let sees: Vec<Vec<usize>> = systems.par_iter().map(|system| seen_by(system, &senders)).collect();
    let mut sets = DisjointSets::new(systems.len());
    for (k, seen) in sees.iter().enumerate() {
        seen.iter().for_each(|&l| sets.join(k, l));
    }
    sets.into_sets().into_iter().map(|members| Group::of(systems, members, &senders, &sees)).collect()
}

/// The instances that an instance receives light from.
fn seen_by(system: &InstanceSystem, senders: &[Range<usize>]) -> Vec<usize> {
    let mut seen = vec![false; senders.len()];
    for sender in system.coupling.senders_seen() {
        seen[senders.partition_point(|of| of.end <= sender)] = true;
    }
    (0..seen.len()).filter(|&l| seen[l]).collect()
}

/// Consecutive ranges of these lengths.
pub fn ranges(lengths: impl Iterator<Item = usize>) -> Vec<Range<usize>> {
    lengths
        .scan(0, |end, length| {
            *end += length;
            Some(*end - length..*end)
        })
        .collect()
}

impl<'a> Group<'a> {
    fn of(
        systems: &'a [InstanceSystem<'a>],
        members: Vec<usize>,
        senders: &[Range<usize>],
        sees: &[Vec<usize>],
    ) -> Self {
        let place = |l: &usize| members.binary_search(l).expect("what a member sees is in its group");
        Self {
            systems,
            elements: ranges(members.iter().map(|&k| systems[k].areas.len())),
            senders: members.iter().map(|&k| senders[k].clone()).collect(),
            sees: members.iter().map(|&k| sees[k].iter().map(place).collect()).collect(),
            active: members.iter().map(|&k| ActiveRows::of(&systems[k])).collect(),
            scene_senders: senders.last().map_or(0, |last| last.end),
            members,
        }
    }

    /// A member's block row of the equation.
    pub fn system(&self, member: usize) -> &'a InstanceSystem<'a> {
        &self.systems[self.members[member]]
    }

    /// The range of a member's elements in a vector of the group.
    pub fn elements_of(&self, member: usize) -> Range<usize> {
        self.elements[member].clone()
    }

    /// Number of elements.
    pub fn elements(&self) -> usize {
        self.elements.last().map_or(0, |last| last.end)
    }

    /// The range of a member's senders among those of the whole scene.
    pub fn senders_of(&self, member: usize) -> Range<usize> {
        self.senders[member].clone()
    }

    /// Number of senders of the whole scene: elements and clusters.
    pub fn scene_senders(&self) -> usize {
        self.scene_senders
    }

    /// Number of instances of the whole scene.
    pub fn scene_instances(&self) -> usize {
        self.systems.len()
    }

    /// Write the radiosity of a member's nodes, W/m², into the vector of all senders of the scene.
    pub fn send(&self, member: usize, radiosity: &[Rgb], all: &mut [Rgb]) {
        all[self.senders_of(member)].copy_from_slice(&self.system(member).clusters.means(radiosity));
    }

    /// Irradiance of a member's elements from all other members, W/m²; zero for skipped rows.
    pub fn arriving(&self, member: usize, all: &[Rgb]) -> Vec<Rgb> {
        self.active[member].coupled_irradiance(self.system(member), all)
    }

    /// F B, W/m²; zero for skipped rows.
    pub fn irradiance(&self, radiosity: &[Rgb]) -> Vec<Rgb> {
        self.irradiance_of(&self.active, radiosity)
    }

    /// F B of the skipped rows, W/m²; zero for all others.
    pub fn skipped_irradiance(&self, radiosity: &[Rgb]) -> Vec<Rgb> {
        let skipped: Vec<ActiveRows> = self.active.iter().map(ActiveRows::inactive).collect();
        self.irradiance_of(&skipped, radiosity)
    }

    fn irradiance_of(&self, active: &[ActiveRows], radiosity: &[Rgb]) -> Vec<Rgb> {
        let mut all = vec![Rgb::BLACK; self.scene_senders];
        (0..self.members.len()).for_each(|m| self.send(m, &radiosity[self.elements_of(m)], &mut all));
        let of = |m: usize| -> Vec<Rgb> {
            let own = active[m].own_irradiance(self.system(m), &all[self.senders_of(m)]);
            let others = active[m].coupled_irradiance(self.system(m), &all);
            own.iter().zip(others).map(|(&own, other)| own + other).collect()
        };
        (0..self.members.len()).flat_map(of).collect()
    }

    /// Residual E + ρH − B, W/m², with the irradiance H that belongs to the radiosity B.
    pub fn residual(&self, radiosity: &[Rgb], irradiance: &[Rgb]) -> Vec<Rgb> {
        let emission = self.systems().flat_map(|system| &system.optics.emission);
        emission.zip(self.image(radiosity, irradiance)).map(|(&e, image)| e - image).collect()
    }

    /// B − ρH, W/m², with the irradiance H that belongs to the radiosity B.
    pub fn image(&self, radiosity: &[Rgb], irradiance: &[Rgb]) -> Vec<Rgb> {
        let reflectance = self.systems().flat_map(|system| &system.optics.reflectance);
        let rows = reflectance.zip(radiosity.iter().zip(irradiance));
        rows.map(|(&rho, (&b, &h))| b - rho * h).collect()
    }

    /// The members' block rows of the equation.
    pub fn systems(&self) -> impl Iterator<Item = &'a InstanceSystem<'a>> {
        self.members.iter().map(|&k| &self.systems[k])
    }

    /// Number of rows that are skipped until the end.
    pub fn skipped(&self) -> usize {
        self.systems().zip(&self.active).map(|(system, active)| active.skipped(system)).sum()
    }
}
