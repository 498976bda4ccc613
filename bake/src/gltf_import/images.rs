//! Images behind textures: in go PNG and JPEG files, embedded or beside the glTF file, out come [`Texture`]s. Read are only
//! images that colour what is baked.

use super::buffers::uri_bytes;
use super::document::Document;
use super::files::Files;
use equilux_formats::{Error, Result, Texture, Wrap};
use gltf::image::Source;
use gltf::texture::WrappingMode;
use image::{ImageFormat, ImageReader, RgbaImage};
use std::collections::{BTreeSet, HashMap};
use std::io::Cursor;
use std::path::Path;
use std::sync::Arc;

/// The pixels of the images of `gltf` that colour reflectance or emission, by number.
pub(super) fn read_images(
    files: &mut Files,
    path: &Path,
    gltf: &gltf::Document,
    buffers: &[Vec<u8>],
) -> Result<HashMap<usize, RgbaImage>> {
    let of = |material: gltf::Material| {
        let reflectance = material.pbr_metallic_roughness().base_color_texture();
        [reflectance, material.emissive_texture()].map(|info| Some(info?.texture().source().index()))
    };
    let used: BTreeSet<usize> = gltf.materials().flat_map(of).flatten().collect();
    let used = gltf.images().filter(|image| used.contains(&image.index()));
    used.map(|image| Ok((image.index(), read_image(files, path, &image, buffers)?))).collect()
}

fn read_image(files: &mut Files, path: &Path, image: &gltf::Image, buffers: &[Vec<u8>]) -> Result<RgbaImage> {
    let named = image.name().or(match image.source() {
        Source::Uri { uri, .. } if !uri.starts_with("data:") => Some(uri),
        _ => None,
    });
    let what = format!("image {}", named.map_or_else(|| image.index().to_string(), str::to_owned));
    let decoded = match image.source() {
        Source::Uri { uri, .. } => decode(&uri_bytes(files, path, uri, &what)?),
        Source::View { view, .. } => {
            let end = view.offset().checked_add(view.length());
            let bytes = end.and_then(|end| buffers[view.buffer().index()].get(view.offset()..end));
            bytes.map_or_else(|| Err("its buffer view reaches past its buffer".to_owned()), decode)
        }
    };
    decoded.map_err(|why| {
        Error::new(
            path,
            format!("{what} cannot be decoded ({why})"),
            "a PNG or JPEG image",
            "save the image again, or remove the texture",
        )
    })
}

/// The pixels of a PNG or JPEG file, whatever it is called. Of 16-bit channels the upper bits stay.
fn decode(bytes: &[u8]) -> std::result::Result<RgbaImage, String> {
    let format = image::guess_format(bytes).ok();
    let Some(format @ (ImageFormat::Png | ImageFormat::Jpeg)) = format else {
        return Err("neither PNG nor JPEG".to_owned());
    };
    let image = ImageReader::with_format(Cursor::new(bytes), format).decode();
    let image = image.map_err(|error| error.to_string())?.into_rgba8();
    if image.as_raw().is_empty() { Err("it has no pixels".to_owned()) } else { Ok(image) }
}

/// What becomes of an image's alpha.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(super) enum Alpha {
    /// All is there.
    Ignored,
    /// What has at least this alpha is there, of 255.
    From(u16),
    /// So much of the surface is there.
    Share,
}

/// The textures of one document, each once.
#[derive(Default)]
pub(super) struct Textures(HashMap<(usize, [Wrap; 2], Alpha), Arc<Texture>>);

impl Textures {
    /// The texture `source` of `document`.
    pub(super) fn get(&mut self, document: &Document, source: &gltf::Texture, alpha: Alpha) -> Arc<Texture> {
        let (image, sampler) = (source.source().index(), source.sampler());
        let wrap = [sampler.wrap_s(), sampler.wrap_t()].map(wrap);
        let made = self.0.entry((image, wrap, alpha));
        Arc::clone(made.or_insert_with(|| Arc::new(texture(&document.images[&image], wrap, alpha))))
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
