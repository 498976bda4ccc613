//! The direct irradiance D of a scene's elements from lights that are not elements. Input: placed parts and lights.
//! Output: D, W/m². The light of lamps and suns is averaged over each element and stores no form factors. Form
//! factors between elements and the cells of the sky are cached, so a different sky costs no new form factors.

use crate::equation::coupling::Coupler;
use crate::gather::Gather;
use crate::gather::faces::CoplanarFaces;
use crate::gather::lights::Lights;
use crate::gather::surface_piece::SurfacePiece;
use equilux_bake::equilibrium::apply;
use equilux_bake::oven::cached::cached;
use equilux_bake::treecode::{Audience, EXACT, Request, Resolution, block};
use equilux_bake::world::World;
use equilux_formats::{Element, Optics, Result, Rgb, Rows};

/// The direct irradiance of all elements.
#[derive(Debug)]
pub struct Direct {
    /// D, W/m², one vector of unknowns for each instance.
    pub irradiance: Vec<Vec<Rgb>>,
    /// Radiosity that travels by D instead of along the rows, W/m²; likewise.
    pub apart: Vec<Vec<Rgb>>,
    /// The part of D that comes from it, W/m²; likewise.
    pub from_apart: Vec<Vec<Rgb>>,
    /// The part of D whose shadows are sharp: of emitting surfaces, lamps and suns, W/m²; likewise. Only where rows are by rays.
    pub sharp: Vec<Vec<Rgb>>,
    /// Form factors computed for the sky.
    pub computed: usize,
    /// The names of the lamps and suns that light no element.
    pub unlit: Vec<String>,
}

/// A lamp that delivers no more than this share of its power lights nothing: rounding at the edges of occluders.
const UNLIT_SHARE: f64 = 1e-9;

/// D of all elements. Fails if the monitor was stopped.
pub fn direct(coupler: &Coupler, lights: &Lights) -> Result<Direct> {
    let placed = coupler.placed;
    let apart = placed.split(&vec![Rgb::BLACK; placed.world.elements.len()]);
    let LampLight { irradiance, unlit } = of_lamps(coupler, lights);
    let mut irradiance = placed.split(&irradiance);
    let mut computed = 0;
    if let Some((dome, sends)) = &lights.sky {
        let mut world = placed.stage();
        let sky = world.add_far(dome);
        let seen = dome.clusters.means(sends);
        for (k, own) in irradiance.iter_mut().enumerate() {
            let (rows, new) = sky_block(coupler, &world, sky, k)?;
            computed += new;
            if new == 0 {
                coupler.monitor.spare(own.len() as f64);
            }
            own.iter_mut().zip(apply(&rows, &seen)).for_each(|(sum, h)| *sum += h);
        }
    }
    Ok(Direct { irradiance, from_apart: apart.clone(), apart, sharp: vec![], computed, unlit })
}

/// Light that arrives from lamps and suns.
#[derive(Debug)]
pub struct LampLight {
    /// W/m², one row for each element of the world.
    pub irradiance: Vec<Rgb>,
    /// The names of those that light no element.
    pub unlit: Vec<String>,
}

impl LampLight {
    /// Add the irradiance of these elements, W/m², from a lamp that could send them at most `power`, W.
    pub fn add(&mut self, name: &str, power: Rgb, elements: &[Element], irradiance: &[Rgb]) {
        let mut arrived = Rgb::BLACK;
        for ((sum, element), &h) in self.irradiance.iter_mut().zip(elements).zip(irradiance) {
            *sum += h;
            arrived += h * element.area;
        }
        let is_lost = |(arrived, power): (f64, f64)| arrived <= UNLIT_SHARE * power;
        if power != Rgb::BLACK && arrived.into_iter().zip(power).all(is_lost) {
            self.unlit.push(name.to_owned());
        }
    }
}

/// The light of lamps and suns, averaged over each element.
fn of_lamps(coupler: &Coupler, lights: &Lights) -> LampLight {
    let placed = coupler.placed;
    let elements = &placed.world.elements;
    let dark = vec![Rgb::BLACK; elements.len()];
    if lights.lamps.is_empty() && lights.suns.is_empty() {
        return LampLight { irradiance: dark, unlit: vec![] };
    }
    coupler.monitor.begin("light of lamps", 0, 0.0);
    let mut arriving = LampLight { irradiance: dark.clone(), unlit: vec![] };
    let gather = |lights: &Lights| Gather::new(placed, &dark, &dark, lights, EXACT);
    let none = gather(&Lights::default());
    let planes: Vec<CoplanarFaces> = elements.iter().map(|e| none.faces().plane_of(e.face)).collect();
    let piece = |(e, plane)| {
        let e: &Element = e;
        SurfacePiece { corners: e.corners.as_slice(), normal: e.normal, plane }
    };
    let pieces: Vec<SurfacePiece> = elements.iter().zip(&planes).map(piece).collect();
    for lamp in &lights.lamps {
        arriving.add(&lamp.name, lamp.power, elements, &lamp.irradiance(none.world(), &pieces));
    }
    for sun in &lights.suns {
        let alone = gather(&Lights { suns: vec![sun.clone()], ..Lights::default() });
        arriving.add(&sun.name, sun.power, elements, &alone.direct(&pieces, Rgb::BLACK));
    }
    arriving
}

/// The form factors from an instance's elements to the sky's cells, and the number of form factors computed. Fails if
/// the monitor was stopped.
fn sky_block(coupler: &Coupler, world: &World, sky: usize, instance: usize) -> Result<(Rows, usize)> {
    let name = coupler.name(instance, "sky");
    let manifest = coupler.keys.sky_manifest(instance);
    let mut computed = 0;
    let found = cached(coupler.store, &name, &manifest, coupler.monitor, || {
        coupler.monitor.begin(
            format!("sky of {}", coupler.placed.instances[instance].name),
            world.elements_of(instance).len(),
            world.elements_of(instance).len() as f64,
        );
        // Clusters are not used: cells differ in radiance, and each sky differs in another way.
        let resolution = Resolution { opening: 0.0, ..coupler.resolution };
        let senders = [sky];
        let request = Request::new(world, Audience::Instance(instance), &senders, resolution)
            .with_columns(world.nodes_of(sky));
        let timed = block(&request, coupler.monitor)?;
        computed = timed.computed;
        Ok(timed.block)
    });
    Ok((found?.0, computed))
}

/// The optics with emission E + ρD − A, which drives the exchange; A is the radiosity that does not travel along the rows.
pub fn driven(optics: &Optics, direct: &[Rgb], apart: &[Rgb]) -> Optics {
    let rows = optics.emission.iter().zip(&optics.reflectance).zip(direct).zip(apart);
    let emission = rows.map(|(((&e, &rho), &d), &a)| e - a + rho * d).collect();
    Optics { emission, reflectance: optics.reflectance.clone() }
}

/// Add D to the irradiance.
pub fn with_direct(irradiance: &mut [Rgb], direct: &[Vec<Rgb>]) {
    irradiance.iter_mut().zip(direct.iter().flatten()).for_each(|(h, &d)| *h += d);
}
