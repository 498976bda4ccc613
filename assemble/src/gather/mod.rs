//! Evaluates the light of a solved scene at points and over pieces of surface.
//!
//! Light of emitting surfaces has sharp shadows: its form factors are exact and averaged over the piece. Reflected
//! light is smooth: its irradiance is gathered at points, with the same exact visibility.
//!
//! ```text
//! emitting surfaces, suns → direct light, averaged over the piece
//! lamps → direct light, clipped exactly
//! radiosity ρH of all elements, sky → reflected light, at points
//! ```

pub mod average;
mod cone;
mod directions;
pub mod faces;
pub mod glowing;
mod hemisphere;
pub mod lamps;
pub mod lights;
pub mod outside;
pub mod points;
pub mod receiver;
pub mod sampling;
pub mod sky;
pub mod surface_piece;

use crate::placed_parts::PlacedParts;
use equilux_bake::equilibrium::apply;
use equilux_bake::geometry::aabb::Aabb;
use equilux_bake::monitor::Monitor;
use equilux_bake::rays::scenery::Scenery;
use equilux_bake::treecode::{Audience, EXACT, Request, Resolution, block};
use equilux_bake::world::World;
use equilux_formats::{Element, Rgb, Rows};
use faces::Faces;
use glam::DVec3;
use lamps::Lamp;
use lights::Lights;
use outside::frame;
use std::sync::Arc;

/// Points closer to a plane than this share of the examined region lie in it, since corners are stored as f32.
const COPLANAR_TOLERANCE: f64 = 1e-6;

/// A solved scene whose light can be evaluated.
#[derive(Debug)]
pub struct Gather {
    world: World,
    faces: Faces,
    /// The instances of the scene.
    scene: Vec<usize>,
    /// Reflected radiosity of the scene's nodes, W/m²; zero for added senders.
    reflected: Vec<Rgb>,
    /// The instances added for emitting surfaces and suns.
    glowing: Vec<usize>,
    /// The instance of the sky, if there is one.
    sky: Option<usize>,
    /// Radiosity of the nodes of added senders, W/m²; zero for the scene.
    shining: Vec<Rgb>,
    lamps: Vec<Lamp>,
    resolution: Resolution,
    /// The scene for rays, if its rows are counted rays.
    scenery: Option<Arc<Scenery>>,
    /// The centre of the scene, around which the sky lies.
    centre: DVec3,
}

impl Gather {
    /// The placed scene with these lights. `emission` and `radiosity` of all elements, W/m²; both are zero for a
    /// scene that is not solved yet.
    pub fn new(
        placed: &PlacedParts,
        emission: &[Rgb],
        radiosity: &[Rgb],
        lights: &Lights,
        resolution: Resolution,
    ) -> Self {
        let mut world = placed.stage();
        let scene: Vec<usize> = (0..world.instances()).collect();
        let (faces, centre) = (Faces::of(&world), frame(&world).0);
        let reflected: Vec<Rgb> = radiosity.iter().zip(emission).map(|(&b, &e)| b - e).collect();
        let mut reflected: Vec<Rgb> = placed
            .split(&reflected)
            .iter()
            .enumerate()
            .flat_map(|(k, own)| placed.part_of(k).part.geometry.clusters.means(own))
            .collect();
        let mut shining = vec![Rgb::BLACK; reflected.len()];
        let mut glowing = Vec::new();
        let surfaces = glowing::surfaces(placed, emission);
        if !surfaces.elements.is_empty() {
            glowing.push(world.add_senders(&surfaces.elements, &surfaces.clusters));
            shining.extend(surfaces.clusters.means(&surfaces.emission));
        }
        for sun in &lights.suns {
            glowing.push(world.add_far(&sun.polygons));
            shining.resize(world.nodes.len(), sun.radiosity);
        }
        let sky = lights.sky.as_ref().map(|(dome, sends)| {
            shining.extend(dome.clusters.means(sends));
            world.add_far(dome)
        });
        reflected.resize(world.nodes.len(), Rgb::BLACK);
        let lamps = lights.lamps.clone();
        let scenery = placed.scenery.clone();
        Self { world, faces, scene, reflected, glowing, sky, shining, lamps, resolution, scenery, centre }
    }

    /// The faces of the scene, for finding the face of a point.
    pub fn faces(&self) -> &Faces {
        &self.faces
    }

    /// The world of the scene and the added senders.
    pub fn world(&self) -> &World {
        &self.world
    }

    /// The lamps.
    pub fn lamps(&self) -> &[Lamp] {
        &self.lamps
    }

    /// Exact irradiance at points from emitting surfaces and suns, W/m².
    pub fn glow(&self, points: &[Element]) -> Vec<Rgb> {
        self.from(points, &self.glowing, &self.shining, EXACT)
    }

    /// Irradiance at points from reflecting surfaces and from the sky, W/m².
    pub fn reflected(&self, points: &[Element]) -> Vec<Rgb> {
        self.reflected_within(points, self.resolution)
    }

    /// The same with a form factor to each element, whatever way rows are computed.
    pub fn exact_reflected(&self, points: &[Element]) -> Vec<Rgb> {
        self.reflected_within(points, EXACT)
    }

    fn reflected_within(&self, points: &[Element], resolution: Resolution) -> Vec<Rgb> {
        let reflected = self.from(points, &self.scene, &self.reflected, resolution);
        let sky = self.from(points, self.sky.as_slice(), &self.shining, EXACT);
        reflected.into_iter().zip(sky).map(|(a, b)| a + b).collect()
    }

    /// Irradiance at points from all light, W/m².
    pub fn irradiance(&self, points: &[Element]) -> Vec<Rgb> {
        let reflected = match &self.scenery {
            Some(scenery) => self.reflected_by_rays(scenery, points),
            None => self.reflected(points),
        };
        self.sharp(points).into_iter().zip(reflected).map(|(a, b)| a + b).collect()
    }

    /// Exact irradiance at points from emitting surfaces, lamps and suns, W/m².
    pub fn sharp(&self, points: &[Element]) -> Vec<Rgb> {
        let mut found = self.glow(points);
        for lamp in &self.lamps {
            let arriving = points.iter().map(|point| lamp.at(&self.world, point));
            found.iter_mut().zip(arriving).for_each(|(sum, h)| *sum += h);
        }
        found
    }

    /// Whether any geometry with corners on the lit side of the plane through `point` may lie in a box.
    pub fn anything_before(&self, bounds: Aabb, point: DVec3, normal: DVec3) -> bool {
        let slack = COPLANAR_TOLERANCE * bounds.diagonal();
        let before = |corner: &DVec3| normal.dot(*corner - point) > slack;
        let apart = |other: &Aabb| !other.meets(&bounds);
        self.world.occluders().any(apart, |occluder| occluder.corners.iter().any(before))
    }

    fn from(&self, points: &[Element], senders: &[usize], sent: &[Rgb], resolution: Resolution) -> Vec<Rgb> {
        if senders.is_empty() {
            return vec![Rgb::BLACK; points.len()];
        }
        apply(&self.rows(points, senders, resolution), sent)
    }

    /// The rows of form factors of points; columns count all nodes of the world.
    fn rows(&self, points: &[Element], senders: &[usize], resolution: Resolution) -> Rows {
        let request = Request::new(&self.world, Audience::Points(points), senders, resolution);
        // Calls are short; the caller checks whether the run was stopped.
        block(&request, &Monitor::default()).expect("not stopped").block
    }
}
