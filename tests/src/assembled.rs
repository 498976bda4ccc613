//! Parts with all their blocks in memory, for exchanges without files. Reflectance can be changed without computing
//! form factors.

use equilux_assemble::exchange::exchange;
use equilux_assemble::exchange::listener::Unobserved;
use equilux_assemble::exchange::outcome::Outcome;
use equilux_assemble::exchange::settings::{Goal, Method};
use equilux_assemble::exchange::system::InstanceSystem;
use equilux_bake::equilibrium::{LocalSystem, default_solver};
use equilux_bake::monitor::Monitor;
use equilux_bake::oven::local_equilibrium;
use equilux_bake::treecode::{Audience, Request, Resolution, block};
use equilux_bake::world::World;
use equilux_formats::baked::LocalEquilibrium;
use equilux_formats::{Geometry, LocalSolver, Optics, Rgb, Rows};
use glam::DAffine3;

/// Parts, their blocks, and their light on their own.
#[derive(Debug)]
pub struct Assembled {
    /// The parts' elements, each in its place.
    pub geometries: Vec<Geometry>,
    /// Reflectance and emission.
    pub optics: Vec<Optics>,
    /// F_kk.
    pub self_blocks: Vec<Rows>,
    /// F_kl for l ≠ k.
    pub couplings: Vec<Rows>,
    locals: Vec<LocalEquilibrium>,
}

impl Assembled {
    /// These geometries with these optics; every local equilibrium by `solver`, or by the default for its size.
    pub fn new(
        geometries: Vec<Geometry>,
        optics: Vec<Optics>,
        resolution: Resolution,
        solver: Option<LocalSolver>,
    ) -> Self {
        let world = World::new(geometries.iter().map(|g| (g, DAffine3::IDENTITY)));
        let rows = |receivers: usize, senders: &[usize], columns| {
            let request = Request::new(&world, Audience::Instance(receivers), senders, resolution)
                .with_columns(columns);
            block(&request, &Monitor::default()).expect("not stopped").block
        };
        let all = 0..geometries.len();
        let self_blocks = all.clone().map(|k| rows(k, &[k], world.nodes_of(k))).collect();
        let others = |k: usize| all.clone().filter(|&l| l != k).collect::<Vec<_>>();
        let couplings = all.clone().map(|k| rows(k, &others(k), 0..world.nodes.len())).collect();
        let mut assembled = Self { geometries, optics, self_blocks, couplings, locals: vec![] };
        assembled.solve_locally(solver);
        assembled
    }

    /// Solves the local equilibria after a change of optics, by `solver` or by the default for a part's size.
    pub fn solve_locally(&mut self, solver: Option<LocalSolver>) {
        let parts = self.geometries.iter().zip(&self.self_blocks).zip(&self.optics);
        let local = |((geometry, block), optics): ((&Geometry, &Rows), &Optics)| {
            let solver = solver.unwrap_or_else(|| default_solver(block.receivers()));
            local_equilibrium(block, geometry, optics, solver)
        };
        self.locals = parts.map(local).collect();
    }

    /// Reflectance of everything.
    pub fn paint(&mut self, reflectance: f64) {
        for optics in &mut self.optics {
            optics.reflectance.fill(Rgb([reflectance; 3]));
        }
        self.solve_locally(None);
    }

    /// The equation of each part.
    pub fn systems(&self) -> Vec<InstanceSystem<'_>> {
        let node = |k: usize| {
            let (block, clusters, local) =
                (&self.self_blocks[k], &self.geometries[k].clusters, &self.locals[k]);
            let optics = &self.optics[k];
            let factors = local.factors.as_ref();
            InstanceSystem {
                optics: optics.clone(),
                self_block: block,
                clusters,
                coupling: &self.couplings[k],
                local: LocalSystem::new(block, clusters, &optics.reflectance, local.solver, factors),
                answers: &local.answers,
                areas: self.geometries[k].elements.iter().map(|element| element.area).collect(),
            }
        };
        (0..self.geometries.len()).map(node).collect()
    }

    /// Exchanges light until `error` is proved, in at most `rounds` rounds.
    pub fn exchange(&self, method: Method, error: f64, rounds: usize) -> Outcome {
        exchange(&self.systems(), method, Goal { error, rounds }, None, &Monitor::default(), &Unobserved)
    }

    /// One vector a part from one of all elements.
    pub fn split(&self, values: &[Rgb]) -> Vec<Vec<Rgb>> {
        let mut rest = values;
        let own = |geometry: &Geometry| {
            let (own, others) = rest.split_at(geometry.elements.len());
            rest = others;
            own.to_vec()
        };
        self.geometries.iter().map(own).collect()
    }

    /// The solution of the same blocks down to rounding.
    pub fn exact(&self) -> Vec<Rgb> {
        self.exchange(Method::Gmres, 0.0, 1000).radiosity
    }
}
