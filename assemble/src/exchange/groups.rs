//! Which parts exchange light at all. In go the parts' couplings; out come groups of parts between which no light passes:
//! each is an equation of its own, with its own brightest radiosity and its own end.

use super::Node;
use super::gather::Active;
use equilux_bake::equilibrium::{added, scaled, subtract};
use equilux_bake::geometry::disjoint_sets::DisjointSets;
use equilux_formats::Rgb;
use rayon::prelude::*;
use std::ops::Range;

/// Parts that exchange light with each other and with no other part. Vectors of a group hold its members' elements, one
/// member after the other.
pub struct Group<'a> {
    nodes: &'a [Node<'a>],
    /// The instances, in order.
    pub members: Vec<usize>,
    /// Where each member's elements lie in a vector of the group.
    elements: Vec<Range<usize>>,
    /// Where each member's senders lie among those of the whole scene.
    senders: Vec<Range<usize>>,
    /// For each member the members that it receives from.
    pub sees: Vec<Vec<usize>>,
    active: Vec<Active>,
    scene_senders: usize,
}

/// The groups of a scene; every instance is in one of them.
pub fn groups<'a>(nodes: &'a [Node<'a>]) -> Vec<Group<'a>> {
    let senders = ranges(nodes.iter().map(|node| node.clusters.nodes()));
    let sees: Vec<Vec<usize>> = nodes.par_iter().map(|node| seen_by(node, &senders)).collect();
    let mut sets = DisjointSets::new(nodes.len());
    for (k, seen) in sees.iter().enumerate() {
        seen.iter().for_each(|&l| sets.join(k, l));
    }
    sets.into_sets().into_iter().map(|members| Group::of(nodes, members, &senders, &sees)).collect()
}

/// The instances that a node receives from.
fn seen_by(node: &Node, senders: &[Range<usize>]) -> Vec<usize> {
    let mut seen = vec![false; senders.len()];
    for sender in node.coupling.senders_seen() {
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
    fn of(nodes: &'a [Node<'a>], members: Vec<usize>, senders: &[Range<usize>], sees: &[Vec<usize>]) -> Self {
        let place = |l: &usize| members.binary_search(l).expect("what a member sees is in its group");
        Self {
            nodes,
            elements: ranges(members.iter().map(|&k| nodes[k].areas.len())),
            senders: members.iter().map(|&k| senders[k].clone()).collect(),
            sees: members.iter().map(|&k| sees[k].iter().map(place).collect()).collect(),
            active: members.iter().map(|&k| Active::of(&nodes[k])).collect(),
            scene_senders: senders.last().map_or(0, |last| last.end),
            members,
        }
    }

    /// A member's share of the equation.
    pub fn node(&self, member: usize) -> &'a Node<'a> {
        &self.nodes[self.members[member]]
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
        self.nodes.len()
    }

    /// Put the radiosity of a member among those of all senders of the scene.
    pub fn send(&self, member: usize, radiosity: &[Rgb], all: &mut [Rgb]) {
        all[self.senders_of(member)].copy_from_slice(&self.node(member).clusters.means(radiosity));
    }

    /// Irradiance of a member's elements from all other members, W/m²; zero for those who wait.
    pub fn arriving(&self, member: usize, all: &[Rgb]) -> Vec<Rgb> {
        self.active[member].coupled_irradiance(self.node(member), all)
    }

    /// F B, W/m²; zero for those who wait.
    pub fn irradiance(&self, radiosity: &[Rgb]) -> Vec<Rgb> {
        self.irradiance_of(&self.active, radiosity)
    }

    /// F B of those who wait, W/m²; zero for all others.
    pub fn waiting_irradiance(&self, radiosity: &[Rgb]) -> Vec<Rgb> {
        let waiting: Vec<Active> = self.active.iter().map(Active::inactive).collect();
        self.irradiance_of(&waiting, radiosity)
    }

    fn irradiance_of(&self, active: &[Active], radiosity: &[Rgb]) -> Vec<Rgb> {
        let mut all = vec![[0.0; 3]; self.scene_senders];
        (0..self.members.len()).for_each(|m| self.send(m, &radiosity[self.elements_of(m)], &mut all));
        let of = |m: usize| -> Vec<Rgb> {
            let own = active[m].own_irradiance(self.node(m), &all[self.senders_of(m)]);
            let others = active[m].coupled_irradiance(self.node(m), &all);
            own.iter().zip(others).map(|(&own, other)| added(own, other)).collect()
        };
        (0..self.members.len()).flat_map(of).collect()
    }

    /// r = E + ρH − B with the irradiance H of that B, W/m².
    pub fn residual(&self, radiosity: &[Rgb], irradiance: &[Rgb]) -> Vec<Rgb> {
        let emission = self.nodes().flat_map(|node| &node.optics.emission);
        emission.zip(self.image(radiosity, irradiance)).map(|(&e, image)| subtract(e, image)).collect()
    }

    /// B − ρH with the irradiance H of that B, W/m².
    pub fn image(&self, radiosity: &[Rgb], irradiance: &[Rgb]) -> Vec<Rgb> {
        let reflectance = self.nodes().flat_map(|node| &node.optics.reflectance);
        let rows = reflectance.zip(radiosity.iter().zip(irradiance));
        rows.map(|(&rho, (&b, &h))| subtract(b, scaled(rho, h))).collect()
    }

    /// The members' shares of the equation.
    pub fn nodes(&self) -> impl Iterator<Item = &'a Node<'a>> {
        self.members.iter().map(|&k| &self.nodes[k])
    }

    /// Number of rows that wait for the end.
    pub fn waiting(&self) -> usize {
        self.nodes().zip(&self.active).map(|(node, active)| active.waiting(node)).sum()
    }
}
