//! Imports punctual lights and cameras.

use super::document::Document;
use super::exporters::light_units;
use super::nodes::PlacedNode;
use super::notes::Notes;
use equilux_formats::{Camera, LightKind, PunctualLight, Result, Rgb};
use glam::{DAffine3, DMat3, DVec3};
use gltf::khr_lights_punctual::{Kind, Light};
use std::f64::consts::{FRAC_PI_2, PI};

/// The light at a node. The scale of the node does not act on its intensity (KHR_lights_punctual).
pub(super) fn light(document: &Document, placed: &PlacedNode, source: &Light) -> Result<PunctualLight> {
    let wrong = |found: String, expected: &str| {
        document.error(format!("light {} with {found}", placed.name()), expected, "correct the light")
    };
    let intensity = source.color().map(|color| f64::from(color) * f64::from(source.intensity()));
    if !intensity.iter().all(|i| i.is_finite() && *i >= 0.0) {
        return Err(wrong(format!("the intensity {intensity:?}"), "finite numbers, 0 or more"));
    }
    let kind = match source.kind() {
        Kind::Point => LightKind::Point,
        Kind::Directional => LightKind::Directional,
        Kind::Spot { inner_cone_angle, outer_cone_angle } => {
            let (inner, outer) = (f64::from(inner_cone_angle), f64::from(outer_cone_angle));
            // glTF bounds the outer angle by π/2, which rounds up in f32.
            if !(0.0 <= inner && inner <= outer && 0.0 < outer && outer <= FRAC_PI_2 + 1e-6) {
                return Err(wrong(
                    format!("innerConeAngle {inner_cone_angle} and outerConeAngle {outer_cone_angle}"),
                    "0 ≤ inner ≤ outer ≤ π/2 and outer above 0",
                ));
            }
            LightKind::Spot { inner, outer: outer.min(FRAC_PI_2) }
        }
    };
    let at_origin = PunctualLight {
        name: placed.name(),
        position: DVec3::ZERO,
        direction: DVec3::NEG_Z,
        intensity: Rgb(intensity),
        units: light_units(document.gltf.as_json().asset.generator.as_deref()),
        kind,
        angle: placed.extras.angular_diameter.unwrap_or(0.0).to_radians(),
    };
    Ok(moved(&at_origin, placed.placement, placed.look.emission_scale))
}

/// `light` after `placement`, with its intensity scaled.
pub(super) fn moved(light: &PunctualLight, placement: DAffine3, emission_scale: f64) -> PunctualLight {
    PunctualLight {
        position: placement.transform_point3(light.position),
        // A degenerate node has no direction; the light keeps its own.
        direction: placement.transform_vector3(light.direction).try_normalize().unwrap_or(light.direction),
        intensity: light.intensity * emission_scale,
        ..light.clone()
    }
}

/// The camera at a node, if its kind is supported.
pub(super) fn camera(document: &Document, placed: &PlacedNode, notes: &mut Notes) -> Result<Option<Camera>> {
    let Some(index) = placed.node.camera().map(|camera| camera.index()) else { return Ok(None) };
    // From the JSON, because the crate relies on the stated type even if its object is missing.
    let Some(lens) = &document.gltf.as_json().cameras[index].perspective else {
        notes.add(
            format!("camera {}", placed.name()),
            "orthographic or of an unknown kind, which is not supported, and ignored",
        );
        return Ok(None);
    };
    let (vertical_fov, aspect) = (f64::from(lens.yfov), lens.aspect_ratio.map(f64::from));
    if vertical_fov >= PI {
        notes.add(format!("camera {}", placed.name()), "its yfov is π or more, and it is ignored");
        return Ok(None);
    }
    if !(vertical_fov > 0.0 && aspect.is_none_or(|ratio| ratio > 0.0 && ratio.is_finite())) {
        return Err(document.error(
            format!("camera {} with yfov {vertical_fov} and aspectRatio {aspect:?}", placed.name()),
            "0 < yfov < π and aspectRatio > 0",
            "correct the camera",
        ));
    }
    let placement = without_scale(placed.placement);
    Ok(Some(Camera { name: placed.name(), placement, vertical_fov, aspect }))
}

/// glTF defines cameras to be unscaled: position, viewing direction and up vector remain.
fn without_scale(placement: DAffine3) -> DAffine3 {
    let back = placement.matrix3.z_axis.normalize_or(DVec3::Z);
    let up = placement.matrix3.y_axis.reject_from_normalized(back);
    let up = up.try_normalize().unwrap_or_else(|| back.any_orthonormal_vector());
    DAffine3 { matrix3: DMat3::from_cols(up.cross(back), up, back), translation: placement.translation }
}
