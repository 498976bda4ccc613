//! Which parts exchange light at all. In go the parts' couplings; out come groups of parts between which no light passes:
//! each is an equation of its own, with its own brightest radiosity and its own end.

use crate::exchange::active_rows::ActiveRows;
use crate::exchange::system::InstanceSystem;
use equilux_formats::Rgb;
use rayon::prelude::*;
use std::ops::Range;

/// Parts that exchange light with each other and with no other part. Vectors of a group hold its members' elements, one
/// member after the other.
pub struct Group<'a> {
    systems: &'a [InstanceSystem<'a>],
    /// The instances, in order.
    pub members: Vec<usize>,
    /// Where each member's elements lie in a vector of the group.
    elements: Vec<Range<usize>>,
    /// Where each member's senders lie among those of the whole scene.
    senders: Vec<Range<usize>>,
    /// For each member the members that it receives from.
    pub sees: Vec<Vec<usize>>,
    active: Vec<ActiveRows>,
    scene_senders: usize,
}

/// The groups of a scene; every instance is in one of them.
pub fn groups<'a>(systems: &'a [InstanceSystem<'a>]) -> Vec<Group<'a>> {
    let senders = ranges(systems.iter().map(|system| system.clusters.nodes()));
    let sees: Vec<Vec<usize>> = systems.par_iter().map(|system| seen_by(system, &senders)).collect();
    let mut group_of: Vec<usize> = (0..systems.len()).collect();
    for (k, seen) in sees.iter().enumerate() {
        for &l in seen {
            let (a, b) = (group_of[k], group_of[l]);
            group_of.iter_mut().filter(|group| **group == a.max(b)).for_each(|group| *group = a.min(b));
        }
    }
    let members = |group: usize| (0..systems.len()).filter(|&k| group_of[k] == group).collect::<Vec<_>>();
    let heads = (0..systems.len()).filter(|&k| group_of[k] == k);
    heads.map(|head| Group::of(systems, members(head), &senders, &sees)).collect()
}

/// The instances that a node receives from.
fn seen_by(system: &InstanceSystem, senders: &[Range<usize>]) -> Vec<usize> {
    let mut seen = vec![false; senders.len()];
    for sender in system.coupling.senders_seen() {
        seen[senders.partition_point(|of| of.end <= sender)] = true;
    }
    (0..seen.len()).filter(|&l| seen[l]).collect()
}

/// Ranges of these lengths, one after the other.
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

    /// A member's share of the equation.
    pub fn system(&self, member: usize) -> &'a InstanceSystem<'a> {
        &self.systems[self.members[member]]
    }

    /// Where a member's elements lie in a vector of the group.
    pub fn elements_of(&self, member: usize) -> Range<usize> {
        self.elements[member].clone()
    }

    /// Number of elements.
    pub fn elements(&self) -> usize {
        self.elements.last().map_or(0, |last| last.end)
    }

    /// Where a member's senders lie among those of the whole scene.
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

    /// Put the radiosity of a member among those of all senders of the scene.
    pub fn send(&self, member: usize, radiosity: &[Rgb], all: &mut [Rgb]) {
        all[self.senders_of(member)].copy_from_slice(&self.system(member).clusters.means(radiosity));
    }

    /// Irradiance of a member's elements from all other members, W/m²; zero for those who wait.
    pub fn arriving(&self, member: usize, all: &[Rgb]) -> Vec<Rgb> {
        self.active[member].coupled_irradiance(self.system(member), all)
    }

    /// F B, W/m²; zero for those who wait.
    pub fn irradiance(&self, radiosity: &[Rgb]) -> Vec<Rgb> {
        self.irradiance_of(&self.active, radiosity)
    }

    /// F B of those who wait, W/m²; zero for all others.
    pub fn waiting_irradiance(&self, radiosity: &[Rgb]) -> Vec<Rgb> {
        let waiting: Vec<ActiveRows> = self.active.iter().map(ActiveRows::inactive).collect();
        self.irradiance_of(&waiting, radiosity)
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

    /// r = E + ρH − B with the irradiance H of that B, W/m².
    pub fn residual(&self, radiosity: &[Rgb], irradiance: &[Rgb]) -> Vec<Rgb> {
        let emission = self.systems().flat_map(|system| &system.optics.emission);
        emission.zip(self.image(radiosity, irradiance)).map(|(&e, image)| e - image).collect()
    }

    /// B − ρH with the irradiance H of that B, W/m².
    pub fn image(&self, radiosity: &[Rgb], irradiance: &[Rgb]) -> Vec<Rgb> {
        let reflectance = self.systems().flat_map(|system| &system.optics.reflectance);
        let rows = reflectance.zip(radiosity.iter().zip(irradiance));
        rows.map(|(&rho, (&b, &h))| b - rho * h).collect()
    }

    /// The members' shares of the equation.
    pub fn systems(&self) -> impl Iterator<Item = &'a InstanceSystem<'a>> {
        self.members.iter().map(|&k| &self.systems[k])
    }

    /// Number of rows that wait for the end.
    pub fn waiting(&self) -> usize {
        self.systems().zip(&self.active).map(|(system, active)| active.waiting(system)).sum()
    }
}
