//! Parsers of option values. Their errors state the expected form.

use crate::gather::sky::Sky;
use crate::proof::sample::ExactRows;
use equilux_bake::cli::length::in_metres;
use equilux_bake::gltf_import::scenes_in;
use equilux_formats::Rgb;
use glam::DVec3;
use std::convert::Infallible;
use std::path::{Path, PathBuf};

pub fn exact_rows(text: &str) -> Result<ExactRows, String> {
    match text.parse() {
        _ if text == "all" => Ok(ExactRows::All),
        Ok(rows) => Ok(ExactRows::About(rows)),
        Err(_) => Err("exact rows are a whole number of them, or `all`".into()),
    }
}

pub fn sky(text: &str) -> Result<Sky, String> {
    let numbers: Vec<Option<f64>> = text.split(',').map(|number| number.trim().parse().ok()).collect();
    match numbers[..] {
        [Some(all)] if all >= 0.0 && all.is_finite() => Ok(Sky::Uniform(Rgb::splat(all))),
        [Some(r), Some(g), Some(b)] if [r, g, b].iter().all(|l| *l >= 0.0 && l.is_finite()) => {
            Ok(Sky::Uniform(Rgb([r, g, b])))
        }
        [None] => Ok(Sky::Picture(text.into())),
        _ => Err("a sky is one number or three with commas between them, 0 or more, or a picture".into()),
    }
}

/// `1%` or `0.01`.
pub fn target_error(text: &str) -> Result<f64, String> {
    let (number, unit) = text.strip_suffix('%').map_or((text, 1.0), |percent| (percent.trim(), 0.01));
    match number.parse::<f64>().map(|number| number * unit) {
        Ok(error) if error > 0.0 && error < 1.0 => Ok(error),
        _ => Err("an error is a share of the mean light between 0 and 1, such as 1% or 0.01".into()),
    }
}

pub fn point(text: &str) -> Result<DVec3, String> {
    let numbers: Option<Vec<f64>> = text.split(',').map(|number| number.trim().parse().ok()).collect();
    match numbers.as_deref() {
        Some(&[x, y, z]) if [x, y, z].iter().all(|v| v.is_finite()) => Ok(DVec3::new(x, y, z)),
        _ => Err(format!(
            "a point is three numbers with commas between them, metres, such as 1,1.6,-2{}",
            in_metres(text)
        )),
    }
}

pub fn atlas_size(text: &str) -> Result<u32, String> {
    match text.parse() {
        Ok(side) if (64..=16384).contains(&side) && u32::is_multiple_of(side, 4) => Ok(side),
        _ => Err("the side of an image is a multiple of 4 from 64 to 16384".into()),
    }
}

pub fn size(text: &str) -> Result<[u32; 2], String> {
    let sides = text.split_once('x').map(|(width, height)| [width.parse().ok(), height.parse().ok()]);
    match sides {
        Some([Some(width), Some(height)]) if [width, height].iter().all(|side| (1..=8192).contains(side)) => {
            Ok([width, height])
        }
        _ => Err("a size is two numbers of pixels from 1 to 8192, such as 1280x720".into()),
    }
}

pub fn field_of_view(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(degrees) if degrees > 0.0 && degrees < 180.0 => Ok(degrees),
        _ => Err("a field of view is an angle between 0 and 180 degrees".into()),
    }
}

pub fn stops(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(stops) if stops.abs() <= 100.0 => Ok(stops),
        _ => Err("an exposure is a number of stops, such as 1 for twice as bright".into()),
    }
}

pub fn texel_size(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(size) if size.is_finite() && size > 0.0 => Ok(size),
        _ => Err(format!("a texel size is a number of metres above zero{}", in_metres(text))),
    }
}

pub fn error_bound(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(error) if error >= 0.0 => Ok(error),
        _ => Err("an error bound is a number, zero or more".into()),
    }
}

/// The path of a scene's file; for a folder with a single scene file, that file.
pub fn scene(text: &str) -> Result<PathBuf, Infallible> {
    match &scenes_in(Path::new(text))[..] {
        [only] => Ok(only.clone()),
        _ => Ok(text.into()),
    }
}

/// A port; 0 for any free port.
pub fn port(text: &str) -> Result<u16, String> {
    text.parse().map_err(|_| "a port is a number up to 65535; the scene comes before --live".into())
}
