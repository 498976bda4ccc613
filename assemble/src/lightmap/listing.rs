//! The contents of a lightmap, for programs: `lightmaps.json`.

use super::names::direction_name;
use super::pack::Spot;
use super::{Lightmap, Units};
use serde_json::{Value, json};

/// Description of the directions.
const DIRECTIONS: &str = "mean direction to the light, scene axes, weighted by the luminance of its irradiance: 1 long where light comes from one direction, 0 where it comes evenly from all";

/// A file in memory.
pub struct File {
    /// Its name.
    pub name: String,
    /// Its contents.
    pub bytes: Vec<u8>,
}

impl File {
    /// A file of this name and these contents.
    pub fn new(name: impl Into<String>, bytes: Vec<u8>) -> Self {
        Self { name: name.into(), bytes }
    }
}

/// The list of images and nodes. `images`: for each image of the lightmap its EXR and its PNG. The numbers in the EXR
/// files are in `units`, times `scale`.
pub fn listing(lightmap: &Lightmap, images: &[[File; 2]], units: Units, scale: f64) -> Value {
    let instances = lightmap.scene.instances.iter().enumerate();
    json!({
        "units": units.name(),
        "scale": scale,
        "texel_size": lightmap.atlas.texel_size,
        "uv": "TEXCOORD_1 of lightmapped.glb (the author's own where it could be kept), times scale, plus offset; (0, 0) is the upper left corner of the image",
        "directions": lightmap.directions.as_ref().map(|_| DIRECTIONS),
        "images": lightmap.atlas.images.iter().zip(images).enumerate().map(|(number, ([width, height], [exr, png]))| json!({
            "file": exr.name, "width": width, "height": height, "blake3": hash(exr),
            "preview": png.name, "preview_blake3": hash(png),
            "direction": lightmap.directions.as_ref().map(|_| direction_name(number)),
        })).collect::<Vec<_>>(),
        "nodes": instances.map(|(number, instance)| json!({
            "name": instance.name,
            "rectangles": rectangles(lightmap, number).into_iter().map(|Rectangle { image, offset, scale }| json!({
                "image": images[image][0].name, "offset": offset, "scale": scale,
            })).collect::<Vec<_>>(),
        })).collect::<Vec<_>>(),
    })
}

fn hash(file: &File) -> String {
    blake3::hash(&file.bytes).to_hex().to_string()
}

/// The rectangle of a sheet in an image: texture coordinates times `scale`, plus `offset`.
pub struct Rectangle {
    /// The image.
    pub image: usize,
    /// In shares of the image.
    pub offset: [f64; 2],
    /// In shares of the image.
    pub scale: [f64; 2],
}

/// The rectangles of an instance's sheets.
pub fn rectangles(lightmap: &Lightmap, instance: usize) -> Vec<Rectangle> {
    let (layout, own) = (lightmap.atlas.layout_of(instance), &lightmap.atlas.instances[instance]);
    let rectangle = |(sheet, spot): (&[u32; 2], &Spot)| {
        let whole = lightmap.atlas.images[spot.image];
        let share = |of: [u32; 2]| [0, 1].map(|side| f64::from(of[side]) / f64::from(whole[side]));
        let (offset, scale) =
            (spot.at.map(|at| at + layout.border), sheet.map(|side| side - 2 * layout.border));
        Rectangle { image: spot.image, offset: share(offset), scale: share(scale) }
    };
    layout.sheets.iter().zip(&own.sheets).map(rectangle).collect()
}
