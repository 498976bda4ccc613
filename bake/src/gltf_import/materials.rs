//! Converts glTF's metallic-roughness materials: base colour → reflectance, emissive factor × strength × π → emission,
//! and the textures of both. All other properties are ignored and noted. [`super::repaint`] handles changes in extras.
//!
//! Light transmitted by transparent surfaces is lost: alpha scales the reflectance, and the surface is opaque.

use super::coordinates::Use;
use super::document::Document;
use super::images::{self, Alpha, image_of};
use super::notes::Notes;
use equilux_formats::texture::Textures;
use equilux_formats::{Material, Result, Rgb};
use gltf::material::AlphaMode;
use gltf::texture::Info;
use std::f64::consts::PI;

/// The extension for transmission, such as glass.
const TRANSMISSION: &str = "KHR_materials_transmission";

/// A material of a file. Factor and strength of the emission are kept separately because either may be repainted.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Paint {
    pub(super) name: String,
    /// Base colour, alpha last.
    pub(super) base_colour: [f64; 4],
    /// Whether its alpha is the share of the surface that exists.
    pub(super) blends: bool,
    pub(super) emissive_factor: [f64; 3],
    /// Including emission scales of nodes.
    pub(super) emissive_strength: f64,
    pub(super) double_sided: bool,
    pub(super) textures: Textures,
}

impl Paint {
    /// Its reflectance and emission.
    pub(super) fn material(&self) -> Material {
        let [red, green, blue, alpha] = self.base_colour;
        let there = if self.blends { alpha } else { 1.0 };
        Material {
            name: self.name.clone(),
            reflectance: Rgb([red, green, blue]) * there,
            emission: Rgb(self.emissive_factor).map(|factor| PI * (factor * self.emissive_strength)),
            double_sided: self.double_sided,
            textures: self.textures.clone(),
        }
    }
}

/// The textures of a material.
#[derive(Debug, Clone, Copy)]
pub(super) struct Uses {
    pub(super) reflectance: Option<Use>,
    pub(super) emission: Option<Use>,
}

impl Uses {
    /// The textures of `source`.
    pub(super) fn of(source: &gltf::Material) -> Self {
        let reflectance = source.pbr_metallic_roughness().base_color_texture();
        let of = |info: Option<Info>| info.filter(|info| image_of(info).is_some()).as_ref().map(Use::of);
        Self { reflectance: of(reflectance), emission: of(source.emissive_texture()) }
    }
}

/// The paint for `source`.
pub(super) fn paint(
    document: &Document,
    source: &gltf::Material,
    shelf: &mut images::Textures,
    notes: &mut Notes,
) -> Result<Paint> {
    let subject = subject(source);
    let pbr = source.pbr_metallic_roughness();
    let base_colour = pbr.base_color_factor().map(f64::from);
    let blends = source.alpha_mode() == AlphaMode::Blend;
    let factors = &base_colour[..if blends { 4 } else { 3 }];
    if !factors.iter().all(|rho| (0.0..=1.0).contains(rho)) {
        return Err(document.error(
            format!("{subject} with the reflectance rho {factors:?}"),
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
        base_colour,
        blends,
        emissive_factor,
        emissive_strength,
        double_sided: source.double_sided(),
        textures: textures(document, source, shelf),
    })
}

fn textures(document: &Document, source: &gltf::Material, shelf: &mut images::Textures) -> Textures {
    let pbr = source.pbr_metallic_roughness();
    let alpha = match source.alpha_mode() {
        AlphaMode::Opaque => Alpha::Ignored,
        AlphaMode::Blend => Alpha::Share,
        AlphaMode::Mask => Alpha::From(least_alpha(source.alpha_cutoff(), pbr.base_color_factor()[3])),
    };
    let mut texture = |info: Option<Info>, alpha| shelf.get(document, &info?, alpha);
    Textures {
        reflectance: texture(pbr.base_color_texture(), alpha),
        emission: texture(source.emissive_texture(), Alpha::Ignored),
    }
}

/// The smallest alpha of a texel, of 255, whose product with `factor` is not below the cutoff.
fn least_alpha(cutoff: Option<f32>, factor: f32) -> u16 {
    let least = f64::from(cutoff.unwrap_or(0.5)) / f64::from(factor) * 255.0;
    if least <= 255.0 { least.ceil() as u16 } else { 256 }
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
    let others = pbr.metallic_roughness_texture().is_some()
        || source.normal_texture().is_some()
        || source.occlusion_texture().is_some();
    if others {
        notes.add(subject, "textures are ignored but for base colour and emission");
    }
    let colours = [pbr.base_color_texture(), source.emissive_texture()];
    for info in colours.into_iter().flatten().filter(|info| image_of(info).is_none()) {
        notes.add(subject, format!("a texture {} is ignored", without_image(&info.texture())));
    }
    if pbr.metallic_factor() > 0.0 {
        notes.add(subject, "metallic, yet reflects its base colour diffusely");
    }
    if source.alpha_mode() != AlphaMode::Opaque {
        notes.add(
            subject,
            "transparent in the file; here it reflects by its alpha and lets nothing through, so that light is lost",
        );
    }
    if source.extension_value(TRANSMISSION).is_some() {
        notes.add(subject, "lets light through in the file, here it is opaque and reflects its base colour");
    }
}

/// The description of a texture without a usable image.
fn without_image(texture: &gltf::Texture) -> String {
    let extensions = texture.extensions().into_iter().flat_map(|extensions| extensions.keys());
    match extensions.cloned().collect::<Vec<_>>().join(", ") {
        none if none.is_empty() => "without an image".to_owned(),
        names => format!("whose only image is one of {names}, which cannot be read here,"),
    }
}

/// Whether two materials are equal except for their names.
pub(super) fn same_material(left: &Material, right: &Material) -> bool {
    (left.reflectance, left.emission, left.double_sided)
        == (right.reflectance, right.emission, right.double_sided)
        && left.textures == right.textures
}
