//! What a surface does with light, from glTF's metallic-roughness material: base colour → reflectance, emissive
//! factor × strength × π → emission. All else a material may hold is ignored and noted. What authors repaint is told by
//! [`super::repaint`].

use super::document::Document;
use super::notes::Notes;
use equilux_formats::{Material, Result};
use std::f64::consts::PI;

/// A material as a file has it. Factor and strength of the emission are kept apart, as either may be repainted.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Paint {
    pub(super) name: String,
    pub(super) reflectance: [f64; 3],
    pub(super) emissive_factor: [f64; 3],
    /// Emission scales of nodes included.
    pub(super) emissive_strength: f64,
    pub(super) double_sided: bool,
}

impl Paint {
    /// What it does with light.
    pub(super) fn material(&self) -> Material {
        Material {
            name: self.name.clone(),
            reflectance: self.reflectance,
            emission: self.emissive_factor.map(|factor| PI * (factor * self.emissive_strength)),
            double_sided: self.double_sided,
        }
    }
}

/// The paint that `source` is.
pub(super) fn paint(document: &Document, source: &gltf::Material, notes: &mut Notes) -> Result<Paint> {
    let subject = subject(source);
    let pbr = source.pbr_metallic_roughness();
    let [red, green, blue, _alpha] = pbr.base_color_factor().map(f64::from);
    let reflectance = [red, green, blue];
    if !reflectance.iter().all(|rho| (0.0..=1.0).contains(rho)) {
        return Err(document.error(
            format!("{subject} with the reflectance rho {reflectance:?}"),
            "0 to 1 in each channel",
            "correct its baseColorFactor",
        ));
    }
    let emissive_strength = f64::from(source.emissive_strength().unwrap_or(1.0));
    let emissive_factor = source.emissive_factor().map(f64::from);
    let radiance = emissive_factor.map(|factor| factor * emissive_strength);
    if !radiance.iter().all(|l| l.is_finite() && *l >= 0.0) {
        return Err(document.error(
            format!("{subject} with the radiance {radiance:?}"),
            "finite numbers, 0 or more",
            "correct its emissiveFactor and emissiveStrength",
        ));
    }
    note_ignored(source, &subject, notes);
    Ok(Paint {
        name: source.name().unwrap_or_default().to_owned(),
        reflectance,
        emissive_factor,
        emissive_strength,
        double_sided: source.double_sided(),
    })
}

fn subject(source: &gltf::Material) -> String {
    match (source.name(), source.index()) {
        (Some(name), _) => format!("material {name}"),
        (None, Some(index)) => format!("material {index}"),
        (None, None) => "default material".to_owned(),
    }
}

fn note_ignored(source: &gltf::Material, subject: &str, notes: &mut Notes) {
    if source.index().is_none() {
        return;
    }
    let pbr = source.pbr_metallic_roughness();
    let textured = pbr.base_color_texture().is_some()
        || pbr.metallic_roughness_texture().is_some()
        || source.normal_texture().is_some()
        || source.occlusion_texture().is_some()
        || source.emissive_texture().is_some();
    if textured {
        notes.add(subject, "textures are ignored, the factors alone count");
    }
    if pbr.metallic_factor() > 0.0 {
        notes.add(subject, "metallic, yet reflects its base colour diffusely");
    }
    if source.alpha_mode() != gltf::material::AlphaMode::Opaque {
        notes.add(subject, "transparent in the file, opaque here");
    }
}

/// Whether two materials do the same with light, whatever they are called.
pub(super) fn same_material(left: &Material, right: &Material) -> bool {
    (left.reflectance, left.emission, left.double_sided)
        == (right.reflectance, right.emission, right.double_sided)
}
