//! One round of the exchange: transfers (steps 7, 8) and local equilibria (steps 5, 6).

use super::gather::Active;
use super::{Node, StepTimes, sources};
use equilux_bake::equilibrium::added;
use equilux_formats::Rgb;
use rayon::prelude::*;
use std::time::{Duration, Instant};

/// The light on its way.
pub struct State<'a> {
    nodes: &'a [Node<'a>],
    /// Who takes part in the rounds, one entry an instance.
    active: Vec<Active>,
    /// Radiosity, one vector an instance.
    pub radiosity: Vec<Vec<Rgb>>,
    /// Irradiance from other instances, as of the last transfer.
    arriving: Vec<Vec<Rgb>>,
    /// Local equilibria that were not asked for, because nothing shone in the instance.
    pub idle: usize,
}

impl<'a> State<'a> {
    /// No light anywhere, and none on its way.
    pub fn dark(nodes: &'a [Node<'a>]) -> Self {
        let dark: Vec<Vec<Rgb>> = nodes.iter().map(|n| vec![[0.0; 3]; n.optics.emission.len()]).collect();
        let active = nodes.iter().map(Active::of).collect();
        Self { nodes, active, radiosity: dark.clone(), arriving: dark, idle: 0 }
    }

    /// All radiosities, instance after instance.
    pub fn flat(&self) -> Vec<Rgb> {
        self.radiosity.concat()
    }

    /// Number of rows that wait for the end.
    pub fn waiting(&self) -> usize {
        self.nodes.iter().zip(&self.active).map(|(node, active)| active.waiting(node)).sum()
    }

    /// Every part to its equilibrium with what arrived, then every transfer.
    pub fn jacobi(&mut self, times: &mut StepTimes) {
        let solve = |(k, arriving): (usize, &Vec<Rgb>)| timed(|| self.solved(k, arriving));
        let solved: Vec<_> = self.arriving.par_iter().enumerate().map(solve).collect();
        for (k, (solved, time)) in solved.into_iter().enumerate() {
            self.settle(k, solved);
            times.solve[k] += time;
        }
        let transfers = self.transfer();
        times.transfer.iter_mut().zip(transfers).for_each(|(total, time)| *total += time);
    }

    /// One part after the other, each with the newest light of all others.
    pub fn gauss_seidel(&mut self, times: &mut StepTimes) {
        for (k, node) in self.nodes.iter().enumerate() {
            let all = self.all();
            let (arriving, time) = timed(|| self.active[k].coupled_irradiance(node, &all));
            times.transfer[k] += time;
            let (solved, time) = timed(|| self.solved(k, &arriving));
            times.solve[k] += time;
            self.settle(k, solved);
        }
        // The bound needs what arrives everywhere at one time; the method itself does not, so it is not counted.
        self.transfer();
    }

    /// The instance's equilibrium with what arrives; none if nothing does and nothing in it shines.
    fn solved(&self, instance: usize, arriving: &[Rgb]) -> Option<Vec<Rgb>> {
        let node = &self.nodes[instance];
        let sources = sources(&node.optics, arriving);
        let shines = sources.iter().any(|source| *source != [0.0; 3]);
        shines.then(|| node.local.solve(&sources, &self.radiosity[instance]))
    }

    fn settle(&mut self, instance: usize, solved: Option<Vec<Rgb>>) {
        self.idle += usize::from(solved.is_none());
        let dark = || vec![[0.0; 3]; self.radiosity[instance].len()];
        self.radiosity[instance] = solved.unwrap_or_else(dark);
    }

    /// The radiosity of all nodes of the scene.
    fn all(&self) -> Vec<Rgb> {
        let mut all = Vec::new();
        self.nodes.iter().zip(&self.radiosity).for_each(|(node, b)| node.clusters.append_means(b, &mut all));
        all
    }

    fn transfer(&mut self) -> Vec<Duration> {
        let all = self.all();
        let receivers = self.nodes.iter().zip(&self.active);
        let arrived = receivers.map(|(node, active)| timed(|| active.coupled_irradiance(node, &all)));
        let (arriving, times) = arrived.unzip();
        self.arriving = arriving;
        times
    }

    /// Irradiance from all instances, as of the last transfer; zero for those who wait.
    pub fn irradiance(&self) -> Vec<Vec<Rgb>> {
        let of = |k: usize| {
            let own = self.active[k].own_irradiance(&self.nodes[k], &self.radiosity[k]);
            own.iter().zip(&self.arriving[k]).map(|(&own, &other)| added(own, other)).collect()
        };
        (0..self.nodes.len()).map(of).collect()
    }

    /// The same with those who waited, for the end.
    pub fn whole_irradiance(&mut self) -> Vec<Vec<Rgb>> {
        self.active = self.nodes.iter().map(Active::all).collect();
        self.transfer();
        self.irradiance()
    }
}

fn timed<T>(work: impl FnOnce() -> T) -> (T, Duration) {
    let start = Instant::now();
    let result = work();
    (result, start.elapsed())
}
