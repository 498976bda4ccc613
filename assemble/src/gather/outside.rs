//! Lights outside the scene's surfaces: the lights of its file, and the sky.

use crate::gather::lamps::Lamp;
use crate::gather::lights::{Lights, Sun};
use crate::gather::sky::{Radiances, dome};
use equilux_bake::elements::clusters::hierarchy;
use equilux_bake::form_factor::contour;
use equilux_bake::geometry::aabb::Aabb;
use equilux_bake::world::World;
use equilux_formats::{
    Corners, Element, Face, FaceId, Geometry, LightKind, LightUnits, MaterialId, PunctualLight,
};
use glam::DVec3;
use std::f64::consts::{PI, TAU};

/// Luminous efficacy that Blender's exporter assumes, lm/W (Standard, PBR_WATTS_TO_LUMENS).
pub const LUMENS_PER_WATT: f64 = 683.0;

/// Distance of suns, in sizes of the scene.
const SUN_DISTANCE: f64 = 1e4;

/// Number of kites that form a sun; its outline has twice as many corners.
const KITES: usize = 8;

/// The lights of a scene that fills `world`. `units`: the units of their intensities; none for the units that each
/// file suggests.
pub fn lights(
    sources: &[PunctualLight],
    units: Option<LightUnits>,
    sky: Option<&Radiances>,
    world: &World,
) -> Lights {
    let (centre, size) = frame(world);
    let sources: Vec<PunctualLight> = sources.iter().map(|light| in_watts(light, units)).collect();
    let is_sun = |light: &&PunctualLight| matches!(light.kind, LightKind::Directional) && light.angle > 0.0;
    let suns = sources.iter().filter(is_sun).map(|light| sun(light, centre, size));
    let lamps = sources.iter().filter(|light| !is_sun(light)).map(|light| Lamp::of(light, centre, size));
    let sky = sky.map(|sky| {
        let dome = dome(centre, size);
        let sends = sky.radiosity(&dome, centre);
        (dome, sends)
    });
    Lights { lamps: lamps.collect(), suns: suns.collect(), sky }
}

/// The centre of a world and its diameter, metres.
pub fn frame(world: &World) -> (DVec3, f64) {
    let around = Aabb::around(world.faces.iter().flat_map(|face| &face.corners));
    if around.is_empty() {
        (DVec3::ZERO, 1.0)
    } else {
        (around.centre(), around.diagonal().max(f64::MIN_POSITIVE))
    }
}

/// `light` with its intensity converted to W/sr or W/m².
pub fn in_watts(light: &PunctualLight, units: Option<LightUnits>) -> PunctualLight {
    let factor = match (units.unwrap_or(light.units), light.kind) {
        (LightUnits::Radiometric, _) | (LightUnits::BlenderRaw, LightKind::Directional) => 1.0,
        (LightUnits::Photometric, _) => 1.0 / LUMENS_PER_WATT,
        (LightUnits::BlenderRaw, _) => 1.0 / (4.0 * PI),
    };
    let intensity = light.intensity.map(|i| i * factor);
    PunctualLight { intensity, units: LightUnits::Radiometric, ..light.clone() }
}

/// A sun as polygons far away that send as much irradiance, at normal incidence, as parallel light of its intensity.
fn sun(light: &PunctualLight, centre: DVec3, size: f64) -> Sun {
    let distance = SUN_DISTANCE * size;
    let middle = centre - light.direction * distance;
    let (u, v) = light.direction.any_orthonormal_pair();
    // A polygon of the disc's area.
    let sides = 2.0 * KITES as f64;
    let radius = distance * (light.angle / 2.0).tan() * (TAU / (sides * (TAU / sides).sin())).sqrt();
    let at = |k: usize| {
        let (sine, cosine) = (TAU * k as f64 / sides).sin_cos();
        middle + (u * cosine + v * sine) * radius
    };
    let facing = |corners: [DVec3; 4]| {
        let [a, b, c, d] = corners;
        let corners = Corners::quad(corners);
        if corners.double_area_vector().dot(light.direction) > 0.0 {
            corners
        } else {
            Corners::quad([a, d, c, b])
        }
    };
    let corners: Vec<Corners> =
        (0..KITES).map(|k| facing([middle, at(2 * k), at(2 * k + 1), at(2 * k + 2)])).collect();
    let elements: Vec<Element> = corners.iter().map(|&c| Element::new(c, MaterialId(0), FaceId(0))).collect();
    let mut outline: Vec<DVec3> = (0..2 * KITES).map(at).collect();
    if (outline[0] - middle).cross(outline[1] - middle).dot(light.direction) < 0.0 {
        outline.reverse();
    }
    let (order, clusters) = hierarchy(&elements);
    let seen: f64 = corners
        .iter()
        .map(|c| {
            let from_centre: Vec<DVec3> = c.as_slice().iter().map(|&p| p - centre).collect();
            contour::form_factor(&from_centre, -light.direction)
        })
        .sum();
    let elements = order.into_iter().map(|i| elements[i]).collect();
    Sun {
        name: light.name.clone(),
        polygons: Geometry { elements, faces: vec![Face::new(outline)], clusters, patches: None },
        radiosity: light.intensity.map(|e| e / seen),
        power: light.intensity.map(|e| e * PI * size * size),
    }
}
