//! Finds lamps inside closed opaque shells, which light nothing outside, such as a lamp in a bulb whose glass is opaque here.
//!
//! A room is also a shell around its lamps. It is distinguished by facing inwards only, containing more than lamps, or
//! being large in its scene.

use crate::geometry::aabb::Aabb;
use crate::geometry::shells::{Shell, closed_shells, winding_number};
use crate::geometry::tolerance::IN_FRONT;
use equilux_formats::{Instance, LightKind, Part, Scene, Surface};
use glam::DVec3;

/// A lamp that lights nothing outside a shell.
#[derive(Debug, Clone, PartialEq)]
pub struct EnclosedLamp {
    /// Its name, or that of the emitting instance.
    pub lamp: String,
    /// The instance around it.
    pub shell: String,
}

/// Winding numbers above this are inside.
const INSIDE: f64 = 0.99;

/// A two-sided shell is a room if its diagonal is more than this share of the scene's.
const LARGE: f64 = 0.5;

/// The lamps of `scene` in closed shells, each with the smallest shell around it.
pub fn enclosed_lamps(scene: &Scene) -> Vec<EnclosedLamp> {
    let lamps: Vec<Lamp> = lamps(scene);
    let mut found: Vec<Option<(f64, String)>> = vec![None; lamps.len()];
    for (number, instance) in scene.instances.iter().enumerate() {
        let part = &scene.parts[instance.part.index()];
        let bounds = Aabb::around(placed(part, instance).flat_map(corners));
        let inside: Vec<usize> =
            (0..lamps.len()).filter(|&lamp| lamps[lamp].points.iter().all(|&p| bounds.holds(p))).collect();
        if inside.is_empty() {
            continue;
        }
        for enclosure in enclosures(part, instance, number) {
            for &lamp in &inside {
                let size = enclosure.bounds.diagonal();
                let is_smallest = found[lamp].as_ref().is_none_or(|(smallest, _)| size < *smallest);
                if is_smallest && enclosure.hides(&lamps[lamp], scene) {
                    found[lamp] = Some((size, instance.name.clone()));
                }
            }
        }
    }
    let enclosed = lamps.into_iter().zip(found);
    enclosed.filter_map(|(lamp, shell)| Some(EnclosedLamp { lamp: lamp.name, shell: shell?.1 })).collect()
}

/// A light source.
struct Lamp {
    name: String,
    /// The points its light starts from, scene coordinates.
    points: Vec<DVec3>,
    /// The instance and its emitting surfaces; none for punctual lights.
    surfaces: Option<(usize, Vec<u32>)>,
}

fn lamps(scene: &Scene) -> Vec<Lamp> {
    let punctual = scene.lights.iter().filter(|light| {
        light.kind != LightKind::Directional && light.intensity.iter().any(|&intensity| intensity > 0.0)
    });
    let punctual =
        punctual.map(|light| Lamp { name: light.name.clone(), points: vec![light.position], surfaces: None });
    let instances = scene.instances.iter().enumerate();
    let surfaces = instances.filter_map(|(number, instance)| surface_lamp(scene, number, instance));
    punctual.chain(surfaces).collect()
}

/// The emitting surfaces of an instance, as a lamp.
fn surface_lamp(scene: &Scene, number: usize, instance: &Instance) -> Option<Lamp> {
    let part = &scene.parts[instance.part.index()];
    let materials = instance.materials(&part.materials);
    let emits = |surface: &Surface| materials[surface.material.index()].emission.iter().any(|&e| e > 0.0);
    let emitting: Vec<u32> = (0..).zip(&part.surfaces).filter(|(_, s)| emits(s)).map(|(at, _)| at).collect();
    let step = IN_FRONT * Aabb::around(placed(part, instance).flat_map(corners)).diagonal();
    let points = emitting.iter().flat_map(|&at| {
        let surface = part.surfaces[at as usize].placed(instance.placement);
        let (middle, normal) = (surface.corners.centroid(), surface.corners.double_area_vector().normalize());
        let back = part.is_two_sided(&surface).then_some(middle - normal * step);
        [Some(middle + normal * step), back].into_iter().flatten()
    });
    let points: Vec<DVec3> = points.collect();
    (!points.is_empty()).then(|| Lamp {
        name: instance.name.clone(),
        points,
        surfaces: Some((number, emitting)),
    })
}

/// A closed shell of an instance.
struct Enclosure {
    /// Its polygons, facing outwards, scene coordinates.
    polygons: Vec<Surface>,
    bounds: Aabb,
    /// The instance, and the numbers of the surfaces.
    instance: usize,
    surfaces: Vec<u32>,
    /// Whether any of it is lit from inside.
    is_lit_inside: bool,
}

/// The shells of an instance without one-sided surfaces that face inwards.
fn enclosures(part: &Part, instance: &Instance, number: usize) -> Vec<Enclosure> {
    let polygons: Vec<&[DVec3]> = part.surfaces.iter().map(|s| s.corners.as_slice()).collect();
    let is_double_sided =
        |surface: usize| part.materials[part.surfaces[surface].material.index()].double_sided;
    let shells = closed_shells(&polygons, is_double_sided).into_iter();
    let looks_out = |shell: &Shell| {
        let members = shell.polygons.iter().zip(&shell.inward);
        members.into_iter().all(|(&surface, &inward)| !inward || is_double_sided(surface as usize))
    };
    let enclosure = |shell: Shell| {
        let outward = shell.polygons.iter().zip(&shell.inward).map(|(&surface, &inward)| {
            let surface = part.surfaces[surface as usize];
            if inward { surface.flipped() } else { surface }.placed(instance.placement)
        });
        let polygons: Vec<Surface> = outward.collect();
        let bounds = Aabb::around(polygons.iter().flat_map(|s| s.corners.as_slice().to_vec()));
        let is_lit_inside = shell.polygons.iter().any(|&surface| is_double_sided(surface as usize));
        Enclosure { polygons, bounds, instance: number, surfaces: shell.polygons, is_lit_inside }
    };
    shells.filter(looks_out).map(enclosure).collect()
}

impl Enclosure {
    /// Whether all of `lamp` is inside, and the shell is not a room.
    fn hides(&self, lamp: &Lamp, scene: &Scene) -> bool {
        let shines_itself = lamp.surfaces.as_ref().is_some_and(|(instance, surfaces)| {
            *instance == self.instance && surfaces.iter().any(|at| self.surfaces.binary_search(at).is_ok())
        });
        !shines_itself
            && lamp.points.iter().all(|&point| self.bounds.holds(point) && self.holds(point))
            && !(self.is_lit_inside && self.is_room(lamp, scene))
    }

    fn holds(&self, point: DVec3) -> bool {
        let polygons = self.polygons.iter().map(|surface| surface.corners.as_slice());
        winding_number(point, polygons) > INSIDE
    }

    /// Whether it is large, or holds surfaces that neither emit nor belong to the lamp.
    fn is_room(&self, lamp: &Lamp, scene: &Scene) -> bool {
        let whole =
            Aabb::around(scene.instances.iter().flat_map(|instance| {
                placed(&scene.parts[instance.part.index()], instance).flat_map(corners)
            }));
        let own = lamp.surfaces.as_ref().map(|(instance, _)| *instance);
        let others = || {
            let instances = scene.instances.iter().enumerate();
            instances.filter(|(number, _)| *number == self.instance || Some(*number) != own)
        };
        self.bounds.diagonal() > LARGE * whole.diagonal()
            || others().any(|(number, instance)| self.holds_something(scene, number, instance))
    }

    /// Whether a surface of an instance that does not emit lies inside and is not of the shell.
    fn holds_something(&self, scene: &Scene, number: usize, instance: &Instance) -> bool {
        let part = &scene.parts[instance.part.index()];
        let materials = instance.materials(&part.materials);
        (0..).zip(placed(part, instance)).any(|(at, surface)| {
            let is_own = number == self.instance && self.surfaces.binary_search(&at).is_ok();
            let middle = surface.corners.centroid();
            !is_own
                && materials[surface.material.index()].emission == [0.0; 3]
                && self.bounds.holds(middle)
                && self.holds(middle)
        })
    }
}

/// The surfaces of an instance, scene coordinates.
fn placed<'a>(part: &'a Part, instance: &'a Instance) -> impl Iterator<Item = Surface> + 'a {
    part.surfaces.iter().map(|surface| surface.placed(instance.placement))
}

fn corners(surface: Surface) -> impl Iterator<Item = DVec3> {
    let count = surface.corners.as_slice().len();
    (0..count).map(move |i| surface.corners.as_slice()[i])
}
