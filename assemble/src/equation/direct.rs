//! The irradiance D of a scene's elements from lights that are no elements: parts in their places, lights → D, W/m². Lamps and
//! suns are averaged over each element, and cost no form factor that is kept; what the sky's
//! cells are to each element is kept in the cache, so that another sky costs nothing.

use crate::equation::coupling::Coupler;
use crate::gather::Gather;
use crate::gather::faces::CoplanarFaces;
use crate::gather::lights::Lights;
use crate::gather::surface_piece::SurfacePiece;
use crate::placed_parts::PlacedParts;
use equilux_bake::equilibrium::apply;
use equilux_bake::oven::cached::cached;
use equilux_bake::treecode::{Audience, EXACT, Request, Resolution, block};
use equilux_bake::world::World;
use equilux_formats::{Element, Optics, Result, Rgb, Rows};

/// What lights send to elements.
#[derive(Debug)]
pub struct Direct {
    /// D, W/m², one vector an instance.
    pub irradiance: Vec<Vec<Rgb>>,
    /// Form factors computed for the sky.
    pub computed: usize,
    /// The names of the lamps and suns of which nothing arrives.
    pub unlit: Vec<String>,
}

/// Of a lamp's power this share is nothing: what rounding leaves at the edges of occluders.
const NOTHING: f64 = 1e-9;

/// D of all elements. Fails if the monitor was stopped.
pub fn direct(coupler: &Coupler, lights: &Lights) -> Result<Direct> {
    let placed = coupler.placed;
    let dark = vec![Rgb::BLACK; placed.world.elements.len()];
    if lights.is_empty() {
        return Ok(Direct { irradiance: placed.split(&dark), computed: 0, unlit: vec![] });
    }
    let LampLight { irradiance, unlit } = if lights.lamps.is_empty() && lights.suns.is_empty() {
        LampLight { irradiance: dark, unlit: vec![] }
    } else {
        coupler.monitor.begin("light of lamps", 0, 0.0);
        of_lamps(placed, lights)
    };
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
    Ok(Direct { irradiance, computed, unlit })
}

/// What arrives of lamps and suns.
struct LampLight {
    /// W/m², one an element of the world.
    irradiance: Vec<Rgb>,
    /// The names of those of which nothing arrives.
    unlit: Vec<String>,
}

impl LampLight {
    /// Adds the irradiance of these elements from a lamp that could send them at most `power`, W.
    fn add(&mut self, name: &str, power: Rgb, elements: &[Element], irradiance: &[Rgb]) {
        let mut arrived = Rgb::BLACK;
        for ((sum, element), &h) in self.irradiance.iter_mut().zip(elements).zip(irradiance) {
            *sum += h;
            arrived += h * element.area;
        }
        let is_lost = |(arrived, power): (f64, f64)| arrived <= NOTHING * power;
        if power != Rgb::BLACK && arrived.into_iter().zip(power).all(is_lost) {
            self.unlit.push(name.to_owned());
        }
    }
}

/// The light of lamps and suns, averaged over each element.
fn of_lamps(placed: &PlacedParts, lights: &Lights) -> LampLight {
    let elements = &placed.world.elements;
    let dark = vec![Rgb::BLACK; elements.len()];
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

/// The form factors of an instance's elements to the sky's cells, and how many were computed.
fn sky_block(coupler: &Coupler, world: &World, sky: usize, instance: usize) -> Result<(Rows, usize)> {
    let name = coupler.name(instance, "sky");
    let manifest = coupler.sky_manifest(instance);
    let mut computed = 0;
    let found = cached(coupler.store, &name, &manifest, coupler.monitor, || {
        coupler.monitor.begin(
            format!("sky of {}", coupler.placed.instances[instance].name),
            world.elements_of(instance).len(),
            world.elements_of(instance).len() as f64,
        );
        // Every cell has its own light, and every sky its own differences between them.
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

/// The same optics with what elements reflect of D as emission: what drives the exchange.
pub fn driven(optics: &Optics, direct: &[Rgb]) -> Optics {
    let rows = optics.emission.iter().zip(&optics.reflectance).zip(direct);
    let emission = rows.map(|((&e, &rho), &d)| e + rho * d).collect();
    Optics { emission, reflectance: optics.reflectance.clone() }
}

/// H with D.
pub fn with_direct(irradiance: &mut [Rgb], direct: &[Vec<Rgb>]) {
    irradiance.iter_mut().zip(direct.iter().flatten()).for_each(|(h, &d)| *h += d);
}
