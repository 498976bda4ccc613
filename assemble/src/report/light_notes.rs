//! Notes on the lights of a scene, known before anything is computed: the units of intensities, implausible
//! intensities, lamps inside closed meshes, and scenes without light.

use crate::gather::outside::{LUMENS_PER_WATT, in_watts};
use crate::gather::sky::Sky;
use equilux_bake::tidy::enclosed_lamps::{EnclosedLamp, enclosed_lamps};
use equilux_formats::{LightKind, LightUnits, PunctualLight, Scene};
use std::f64::consts::PI;

/// Maximum plausible intensity of a lamp, W/sr: more than a kilowatt of light.
const MAX_PLAUSIBLE_LAMP: f64 = 100.0;

/// Maximum plausible irradiance of parallel light, W/m²: the solar constant.
const MAX_PLAUSIBLE_SUN: f64 = 1361.0;

/// Notes on the lights of `scene` under a sky. `units`: units of the intensities, if given on the command line.
pub fn light_notes(scene: &Scene, units: Option<LightUnits>, sky: Option<&Sky>) -> Vec<String> {
    if is_dark(scene, sky) {
        return vec![
            "no light: no surface emits, the file has no lamp, and there is no sky; give --sky 1, or a material an \
             emissiveFactor, or export the lamps (in Blender: Include > Punctual Lights; area lamps are not exported)"
                .to_owned(),
        ];
    }
    let of_units = match units {
        Some(_) => vec![],
        None => units_taken(&scene.lights).into_iter().chain(unbelievable(&scene.lights)).collect(),
    };
    let enclosed = enclosed_lamps(scene);
    let sentences = enclosed.iter().take(MAX_NAMED).map(|EnclosedLamp { lamp, shell }| {
        format!(
            "lamp `{lamp}` stands inside `{shell}`, which is closed and treated as opaque, whatever its alpha: it lights \
             nothing outside; remove `{shell}`, open it, or let it emit instead"
        )
    });
    let more = more(enclosed.len(), "lamps inside closed meshes");
    of_units.into_iter().chain(sentences).chain(more).collect()
}

/// Number of lamps of a kind that are named; the rest are counted.
pub const MAX_NAMED: usize = 3;

/// A note on the lamps of `count` that are not named.
pub fn more(count: usize, what: &str) -> Option<String> {
    count.checked_sub(MAX_NAMED).filter(|&rest| rest > 0).map(|rest| format!("{rest} more {what}"))
}

fn is_dark(scene: &Scene, sky: Option<&Sky>) -> bool {
    let no_sky = match sky {
        None => true,
        Some(Sky::Uniform(radiance)) => *radiance == [0.0; 3],
        Some(Sky::Picture(_)) => false,
    };
    let emits = |instance: &equilux_formats::Instance| {
        let materials = instance.materials(&scene.parts[instance.part.index()].materials);
        materials.iter().any(|material| material.emission != [0.0; 3])
    };
    no_sky
        && scene.lights.iter().all(|light| light.intensity == [0.0; 3])
        && !scene.instances.iter().any(emits)
}

/// The assumed units of a file written by Blender, and how to override them.
fn units_taken(lights: &[PunctualLight]) -> Vec<String> {
    let sentence = |units: LightUnits| {
        match units {
        LightUnits::Radiometric => None,
        LightUnits::Photometric => Some(format!(
            "lamp intensities are taken as candela and lux at {LUMENS_PER_WATT} lm/W (--light-units photometric), as Blender's exporter \
             writes them in its lighting mode Standard; give --light-units radiometric if it was Unitless, blender-raw if it was Raw"
        )),
        LightUnits::BlenderRaw => Some(
            "lamp intensities are taken as watts (--light-units blender-raw), as Blender's exporter wrote them before version 3.4; \
             give --light-units photometric or radiometric if they are not"
                .to_owned(),
        ),
    }
    };
    let mut units: Vec<LightUnits> = lights.iter().map(|light| light.units).collect();
    units.sort_unstable();
    units.dedup();
    units.into_iter().filter_map(sentence).collect()
}

/// A note on a lamp with an implausible intensity.
fn unbelievable(lights: &[PunctualLight]) -> Option<String> {
    let brightness = |light: &PunctualLight| {
        let watts = in_watts(light, None).intensity.into_iter().fold(0.0, f64::max);
        let (most, unit) = match light.kind {
            LightKind::Directional => (MAX_PLAUSIBLE_SUN, "W/m²"),
            LightKind::Point | LightKind::Spot { .. } => (MAX_PLAUSIBLE_LAMP, "W/sr"),
        };
        (watts / most, watts, unit)
    };
    let unknown = lights.iter().filter(|light| light.units == LightUnits::Radiometric);
    let brightest = unknown.max_by(|a, b| brightness(a).0.total_cmp(&brightness(b).0))?;
    let (excess, watts, unit) = brightness(brightest);
    let whole = match brightest.kind {
        LightKind::Directional => "brighter than the sun".to_owned(),
        LightKind::Point | LightKind::Spot { .. } => format!("{:.0} W in all directions", 4.0 * PI * watts),
    };
    (excess > 1.0).then(|| {
        format!(
            "lamp `{}` sends {watts:.0} {unit}, {whole}, because the file's numbers are taken as watts; if they are candela and \
             lux, give --light-units photometric",
            brightest.name
        )
    })
}
