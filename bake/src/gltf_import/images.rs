//! Reads the images of textures: PNG, JPEG and WebP files, embedded or beside the glTF file, as [`Texture`]s. Only
//! images that affect reflectance or emission are read.

use super::buffers::{Buffers, uri_bytes};
use super::document::Document;
use super::files::{Files, file_name};
use super::notes::Notes;
use equilux_formats::texture::{Texture, Wrap};
use equilux_formats::{Error, Result};
use gltf::json;
use gltf::texture::{Info, WrappingMode};
use image::{ImageFormat, ImageReader, RgbaImage};
use std::collections::{BTreeSet, HashMap};
use std::io::Cursor;
use std::path::Path;
use std::sync::Arc;

/// The number of the image of `info`, unless its texture has none in a supported format.
pub(super) fn image_of(info: &Info) -> Option<usize> {
    info.texture().source().map(|image| image.index())
}

/// The pixels of the images of `gltf` that affect reflectance or emission, by number.
pub(super) fn read_images(
    files: &mut Files,
    path: &Path,
    gltf: &gltf::Document,
    buffers: &Buffers,
    notes: &mut Notes,
) -> Result<HashMap<usize, RgbaImage>> {
    let of = |material: gltf::Material| {
        let reflectance = material.pbr_metallic_roughness().base_color_texture();
        [reflectance, material.emissive_texture()].map(|info| info.as_ref().and_then(image_of))
    };
    let used: BTreeSet<usize> = gltf.materials().flat_map(of).flatten().collect();
    let mut pixels = HashMap::new();
    // From the JSON, because the crate panics on images without data.
    for (index, image) in gltf.as_json().images.iter().enumerate() {
        let what = format!("image {}", name(image).map_or_else(|| index.to_string(), str::to_owned));
        if used.contains(&index) {
            pixels.insert(index, read_image(files, path, gltf, buffers, image, &what)?);
        } else if image.uri.is_none() && image.buffer_view.is_none() {
            notes.add(
                file_name(path),
                format!("{what} has neither uri nor bufferView, and nothing here needs it"),
            );
        }
    }
    Ok(pixels)
}

fn name(image: &json::Image) -> Option<&str> {
    let file = image.uri.as_deref().filter(|uri| !uri.starts_with("data:"));
    image.name.as_deref().or(file).filter(|name| !name.is_empty())
}

/// The pixels of `image`. Errors call it `what`.
fn read_image(
    files: &mut Files,
    path: &Path,
    gltf: &gltf::Document,
    buffers: &Buffers,
    image: &json::Image,
    what: &str,
) -> Result<RgbaImage> {
    let view = image.buffer_view.and_then(|view| gltf.views().nth(view.value()));
    let decoded = match (&image.uri, view) {
        (Some(uri), _) => decode(&uri_bytes(files, path, uri, what)?),
        (None, Some(view)) => decode(buffers.view(&view, what)?),
        (None, None) => {
            return Err(Error::new(
                path,
                format!("{what} with neither uri nor bufferView"),
                "one of them, as a material's colour needs the image",
                "export the file again with its images, or remove the texture",
            ));
        }
    };
    decoded.map_err(|why| {
        Error::new(
            path,
            format!("{what} cannot be decoded ({why})"),
            "a PNG, JPEG or WebP image",
            "save the image again, or remove the texture",
        )
    })
}

/// The pixels of a PNG, JPEG or WebP file, identified by its content. 16-bit channels are reduced to 8 bits.
fn decode(bytes: &[u8]) -> std::result::Result<RgbaImage, String> {
    let format = image::guess_format(bytes).ok();
    let Some(format @ (ImageFormat::Png | ImageFormat::Jpeg | ImageFormat::WebP)) = format else {
        return Err("neither PNG nor JPEG nor WebP".to_owned());
    };
    let image = ImageReader::with_format(Cursor::new(bytes), format).decode();
    let image = image.map_err(|error| error.to_string())?.into_rgba8();
    if image.as_raw().is_empty() { Err("it has no pixels".to_owned()) } else { Ok(image) }
}

/// The meaning of an image's alpha.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(super) enum Alpha {
    /// Alpha is ignored.
    Ignored,
    /// The surface exists where alpha, of 255, is at least this.
    From(u16),
    /// Alpha is the share of the surface that exists.
    Share,
}

/// The distinct textures of one document.
#[derive(Default)]
pub(super) struct Textures(HashMap<(usize, [Wrap; 2], Alpha), Arc<Texture>>);

impl Textures {
    /// The texture of `document` that `info` refers to, if it has an image.
    pub(super) fn get(&mut self, document: &Document, info: &Info, alpha: Alpha) -> Option<Arc<Texture>> {
        let (image, sampler) = (image_of(info)?, info.texture().sampler());
        let wrap = [sampler.wrap_s(), sampler.wrap_t()].map(wrap);
        let made = self.0.entry((image, wrap, alpha));
        Some(Arc::clone(made.or_insert_with(|| Arc::new(texture(&document.images[&image], wrap, alpha)))))
    }
}

fn texture(image: &RgbaImage, wrap: [Wrap; 2], alpha: Alpha) -> Texture {
    let texel = |&[red, green, blue, share]: &[u8; 4]| {
        let there = match alpha {
            Alpha::Ignored => 255,
            Alpha::From(least) if u16::from(share) >= least => 255,
            Alpha::From(_) => 0,
            Alpha::Share => share,
        };
        [red, green, blue, there]
    };
    let texels = image.as_raw().as_chunks::<4>().0.iter().map(texel).collect();
    Texture { size: image.dimensions().into(), texels, wrap }
}

fn wrap(mode: WrappingMode) -> Wrap {
    match mode {
        WrappingMode::Repeat => Wrap::Repeat,
        WrappingMode::MirroredRepeat => Wrap::Mirror,
        WrappingMode::ClampToEdge => Wrap::Clamp,
    }
}
