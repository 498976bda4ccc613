//! Sentences about what shines into a scene, known before anything is computed: in which units the intensities of lamps are
//! taken, whether they can be meant so, which lamps stand in closed meshes, and whether anything shines at all.

use crate::gather::outside::{LUMENS_PER_WATT, in_watts};
use crate::gather::sky::Sky;
use equilux_bake::tidy::enclosed_lamps::{EnclosedLamp, enclosed_lamps};
use equilux_formats::{LightKind, LightUnits, PunctualLight, Scene};
use std::f64::consts::PI;

/// No lamp shines with more than this to be believed, W/sr: more than a kilowatt of light.
const BRIGHTEST_LAMP: f64 = 100.0;

/// No parallel light has more to be believed, W/m²: what the sun sends to the earth.
const BRIGHTEST_SUN: f64 = 1361.0;

/// What is to be known of the lights of `scene` under a sky, with their intensities in `units`, if the command line says.
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
    let sentences = enclosed.iter().take(NAMED).map(|EnclosedLamp { lamp, shell }| {
        format!(
            "lamp `{lamp}` stands inside `{shell}`, which is closed and lets no light through here, whatever its alpha: it \
             lights nothing outside; remove `{shell}`, open it, or let it emit instead"
        )
    });
    let more = more(enclosed.len(), "lamps inside closed meshes");
    of_units.into_iter().chain(sentences).chain(more).collect()
}

/// So many lamps of a kind are named.
pub const NAMED: usize = 3;

/// A sentence about those of `count` that are not named.
pub fn more(count: usize, what: &str) -> Option<String> {
    count.checked_sub(NAMED).filter(|&rest| rest > 0).map(|rest| format!("{rest} more {what}"))
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

/// Which units are taken for what Blender wrote, and how to say otherwise.
fn units_taken(lights: &[PunctualLight]) -> Vec<String> {
    let sentence = |units: LightUnits| {
        match units {
        LightUnits::Radiometric => None,
        LightUnits::Photometric => Some(format!(
            "lamps are taken in candela and lux of {LUMENS_PER_WATT} lm/W (--light-units photometric), as Blender's exporter \
             writes them in its lighting mode Standard; give --light-units radiometric if it was Unitless, blender-raw if it was Raw"
        )),
        LightUnits::BlenderRaw => Some(
            "lamps are taken in watts (--light-units blender-raw), as Blender's exporter wrote them before version 3.4; \
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

/// A lamp whose watts can hardly be watts.
fn unbelievable(lights: &[PunctualLight]) -> Option<String> {
    let brightness = |light: &PunctualLight| {
        let watts = in_watts(light, None).intensity.into_iter().fold(0.0, f64::max);
        let (most, unit) = match light.kind {
            LightKind::Directional => (BRIGHTEST_SUN, "W/m²"),
            LightKind::Point | LightKind::Spot { .. } => (BRIGHTEST_LAMP, "W/sr"),
        };
        (watts / most, watts, unit)
    };
    let unknown = lights.iter().filter(|light| light.units == LightUnits::Radiometric);
    let brightest = unknown.max_by(|a, b| brightness(a).0.total_cmp(&brightness(b).0))?;
    let (excess, watts, unit) = brightness(brightest);
    let whole = match brightest.kind {
        LightKind::Directional => "brighter than the sun".to_owned(),
        LightKind::Point | LightKind::Spot { .. } => format!("{:.0} W to all sides", 4.0 * PI * watts),
    };
    (excess > 1.0).then(|| {
        format!(
            "lamp `{}` sends {watts:.0} {unit}, {whole}, as numbers of the file are taken for watts; if they are candela \
             and lux, give --light-units photometric",
            brightest.name
        )
    })
}
