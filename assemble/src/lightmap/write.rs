//! Writes the files of a lightmap: `lightmap.exr`, `lightmap.png`, `lightmapped.glb`, `lightmapped.unlit.glb` and
//! `lightmaps.json`.
//!
//! The unlit model is a separate file, not a variant in the other: KHR_materials_variants shows its second look only
//! in viewers that support it, and most engines do not.

use super::images::{directions_exr, exr, half_scale, peaks, png, relative_png, shown_png};
use super::listing::{File, listing};
use super::model::{ModelLook, model};
use super::names::{direction_name, name};
use super::{Lightmap, Units};
use crate::output_file::{self, WrittenFiles};
use crate::picture::exposure::Exposure;
use equilux_formats::{Error, Result};
use std::io;
use std::path::Path;

/// Write all files of `lightmap` to `folder`, and remove images of an earlier, larger one. Fails if a file cannot be
/// encoded or written.
pub fn write(folder: &Path, lightmap: &Lightmap, units: Units, exposure: Exposure) -> Result<WrittenFiles> {
    let most =
        lightmap.irradiance.iter().flatten().flatten().fold(0.0f64, |most, &h| most.max(h)) * units.factor();
    let scale = half_scale(most);
    let made = files(lightmap, units, scale, exposure).map_err(|error| unmade(folder, &error))?;
    let mut paths = Vec::new();
    for File { name, bytes } in &made {
        let path = folder.join(name);
        output_file::write(&path, |out| out.write_all(bytes))?;
        paths.push(path);
    }
    remove_images_from(folder, lightmap.atlas.images.len(), lightmap.directions.is_some());
    let scaled = format!(
        "half floats cannot hold this lightmap, whose maximum is {most:.3e}: its numbers are multiplied by {scale}"
    );
    let notes = lightmap.atlas.notes.iter().cloned().chain((scale != 1.0).then_some(scaled));
    Ok(WrittenFiles { paths, notes: notes.collect() })
}

/// All files, images first.
fn files(lightmap: &Lightmap, units: Units, scale: f64, exposure: Exposure) -> io::Result<Vec<File>> {
    let numbers = || 0..lightmap.atlas.images.len();
    let pair = |number| {
        let light = exr(lightmap, number, units.factor() * scale)?;
        let preview = png(lightmap, number, exposure)?;
        Ok([File::new(name(number, "exr"), light), File::new(name(number, "png"), preview)])
    };
    let images: Vec<[File; 2]> = numbers().map(pair).collect::<io::Result<_>>()?;
    let list = format!("{:#}\n", listing(lightmap, &images, units, scale)).into_bytes();
    let peaks = peaks(lightmap);
    let relative: Vec<Vec<u8>> =
        numbers().map(|n| relative_png(lightmap, n, &peaks)).collect::<io::Result<_>>()?;
    let shown: Vec<Vec<u8>> =
        numbers().map(|n| shown_png(lightmap, n, exposure)).collect::<io::Result<_>>()?;
    let others = [
        File::new("lightmapped.glb", model(lightmap, &relative, &ModelLook::Emissive(&peaks))?),
        File::new("lightmapped.unlit.glb", model(lightmap, &shown, &ModelLook::Unlit)?),
        File::new("lightmaps.json", list),
    ];
    let directions = |number: usize, of: &Vec<Vec<[f64; 3]>>| {
        Ok(File::new(direction_name(number), directions_exr(lightmap, number, of)?))
    };
    let directions: Vec<File> = lightmap
        .directions
        .iter()
        .flat_map(|of| numbers().map(move |number| directions(number, of)))
        .collect::<io::Result<_>>()?;
    Ok(images.into_iter().flatten().chain(directions).chain(others).collect())
}

/// Remove images numbered `first` and above of an earlier, larger lightmap, and directions that were not requested.
fn remove_images_from(folder: &Path, first: usize, directions: bool) {
    let remove = |name: String| std::fs::remove_file(folder.join(name)).is_ok();
    for number in first.. {
        if [name(number, "exr"), name(number, "png")].map(remove) == [false; 2] {
            break;
        }
    }
    let first = if directions { first } else { 0 };
    (first..).take_while(|&number| remove(direction_name(number))).for_each(drop);
}

fn unmade(folder: &Path, error: &io::Error) -> Error {
    let expected = "images and models that can be encoded";
    Error::new(
        folder,
        format!("the lightmap could not be encoded ({error})"),
        expected,
        "report this as a bug",
    )
}
