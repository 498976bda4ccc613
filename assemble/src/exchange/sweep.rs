//! One round of the exchange: transfers (steps 7, 8) and local equilibria (steps 5, 6).

use super::{Node, StepTimes, sources};
use equilux_bake::equilibrium::{added, apply};
use equilux_formats::Rgb;
use rayon::prelude::*;
use std::time::{Duration, Instant};

/// The light on its way.
pub struct State {
    /// Radiosity, one vector an instance.
    pub radiosity: Vec<Vec<Rgb>>,
    /// Irradiance from other instances, as of the last transfer.
    arriving: Vec<Vec<Rgb>>,
}

impl State {
    /// No light anywhere, and none on its way.
    pub fn dark(nodes: &[Node]) -> Self {
        let dark: Vec<Vec<Rgb>> = nodes.iter().map(|n| vec![[0.0; 3]; n.optics.emission.len()]).collect();
        Self { radiosity: dark.clone(), arriving: dark }
    }

    /// All radiosities, instance after instance.
    pub fn flat(&self) -> Vec<Rgb> {
        self.radiosity.concat()
    }

    /// The radiosity of all nodes of the scene.
    fn nodes(&self, nodes: &[Node]) -> Vec<Rgb> {
        let mut all = Vec::new();
        nodes.iter().zip(&self.radiosity).for_each(|(node, b)| node.clusters.append_means(b, &mut all));
        all
    }

    /// Every part to its equilibrium with what arrived, then every transfer.
    pub fn jacobi(&mut self, nodes: &[Node], times: &mut StepTimes) {
        let solve = |(k, node): (usize, &Node)| {
            timed(|| node.local.solve(&sources(&node.optics, &self.arriving[k]), &self.radiosity[k]))
        };
        let solved: Vec<(Vec<Rgb>, Duration)> = nodes.par_iter().enumerate().map(solve).collect();
        for (k, (b, time)) in solved.into_iter().enumerate() {
            self.radiosity[k] = b;
            times.solve[k] += time;
        }
        let transfers = self.transfer(nodes);
        times.transfer.iter_mut().zip(transfers).for_each(|(total, time)| *total += time);
    }

    /// One part after the other, each with the newest light of all others.
    pub fn gauss_seidel(&mut self, nodes: &[Node], times: &mut StepTimes) {
        for (k, node) in nodes.iter().enumerate() {
            let all = self.nodes(nodes);
            let (arriving, time) = timed(|| apply(node.coupling, &all));
            times.transfer[k] += time;
            let (b, time) = timed(|| node.local.solve(&sources(&node.optics, &arriving), &self.radiosity[k]));
            times.solve[k] += time;
            self.radiosity[k] = b;
        }
        // The bound needs what arrives everywhere at one time; the method itself does not, so it is not counted.
        self.transfer(nodes);
    }

    fn transfer(&mut self, nodes: &[Node]) -> Vec<Duration> {
        let all = self.nodes(nodes);
        let arrived = nodes.iter().map(|node| timed(|| apply(node.coupling, &all)));
        let (arriving, times) = arrived.unzip();
        self.arriving = arriving;
        times
    }

    /// Irradiance from all instances, as of the last transfer.
    pub fn irradiance(&self, nodes: &[Node]) -> Vec<Vec<Rgb>> {
        let own = |node: &Node, b: &[Rgb]| node.local.irradiance(b);
        nodes
            .iter()
            .zip(&self.radiosity)
            .zip(&self.arriving)
            .map(|((node, b), arriving)| {
                own(node, b).iter().zip(arriving).map(|(&o, &a)| added(o, a)).collect()
            })
            .collect()
    }
}

fn timed<T>(work: impl FnOnce() -> T) -> (T, Duration) {
    let start = Instant::now();
    let result = work();
    (result, start.elapsed())
}
