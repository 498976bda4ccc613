//! A requested picture: from a given camera, with flat or smooth light, and optionally its difference from a
//! reference. Input: a [`Shot`] and the light of a scene. Output: PNG files and notes about them.

use crate::output_file::WrittenFiles;
use crate::picture::camera::View;
use crate::picture::canvas::Canvas;
use crate::picture::difference::{Difference, ReferenceLight};
use crate::picture::exposure::Exposure;
use crate::picture::interpolation::InterpolatedIrradiance;
use crate::picture::smooth::corner_irradiance;
use crate::picture::{BACKGROUND, shade, write_png};
use crate::solve::Solved;
use equilux_bake::rays::RayIndex;
use equilux_formats::{Camera, Error, Result, Scene};
use glam::DVec3;
use std::path::{Path, PathBuf};

/// A requested picture.
#[derive(Debug, Clone)]
pub struct Shot {
    /// The viewpoint.
    pub eye: Eye,
    /// Width and height, pixels; none for the camera's default.
    pub size: Option<[u32; 2]>,
    /// How light is drawn.
    pub shading: Shading,
    /// Exposure relative to the automatic one, stops: each doubles the brightness.
    pub stops: f64,
    /// A table of reference light for a picture of the difference in false colours.
    pub against: Option<PathBuf>,
}

impl Shot {
    /// Check before any computation that the viewpoint exists. Fails if there is no such camera or the points
    /// coincide.
    pub fn check(&self, cameras: &[Camera], file: &Path) -> Result<()> {
        match &self.eye {
            Eye::Scene => Ok(()),
            Eye::Camera(name) => camera(name, cameras, file).map(drop),
            Eye::Points { from, to, .. } if from != to => Ok(()),
            Eye::Points { .. } => {
                let expected = "an eye in one place that looks at another";
                Err(Error::new(file, "looks from a point at itself", expected, "move --from or --to"))
            }
        }
    }
}

/// The viewpoint of a picture.
#[derive(Debug, Clone, PartialEq)]
pub enum Eye {
    /// The scene's first camera, or otherwise one that frames the scene.
    Scene,
    /// The scene's camera with this name, or with this number, counting from 1.
    Camera(String),
    /// From one point to another, metres, with a vertical field of view.
    Points {
        /// The position of the camera.
        from: DVec3,
        /// The point in the middle of the picture.
        to: DVec3,
        /// Vertical field of view, radians.
        field_of_view: f64,
    },
}

/// How light is drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "cli", derive(clap::ValueEnum))]
pub enum Shading {
    /// Each element in one colour
    Flat,
    /// Irradiance interpolated between elements that see each other
    Smooth,
}

/// Draw a shot into `folder`. `against`: the loaded reference that `shot` names. Fails if a picture cannot be
/// written.
pub fn draw(
    shot: &Shot,
    against: Option<&ReferenceLight>,
    scene: &Scene,
    solved: &Solved,
    folder: &Path,
) -> Result<WrittenFiles> {
    let equation = &solved.equation;
    let elements = solved.elements();
    let index = RayIndex::new(elements);
    let view = view(shot, scene, || View::framing(elements, &index))?;
    let canvas = Canvas::trace(view, &index);
    let emission = &equation.optics.emission;
    let Exposure(suits) = Exposure::choose(|| canvas.elements(), solved.radiosity(), emission);
    let exposure = Exposure(suits * shot.stops.exp2());
    let corners = match shot.shading {
        Shading::Flat => None,
        Shading::Smooth => Some(corner_irradiance(elements, &index, &solved.irradiance)),
    };
    let light = InterpolatedIrradiance { elements, corners: corners.as_deref(), flat: &solved.irradiance };
    let picture = match shot.shading {
        Shading::Flat => shade(&canvas, solved.radiosity(), exposure),
        Shading::Smooth => canvas.paint(BACKGROUND, |point, element| {
            let h = light.at(element, canvas.view().onto(point, &elements[element]));
            let (e, rho) = (emission[element], equation.optics.reflectance[element]);
            exposure.shown(e + rho * h)
        }),
    };
    let path = folder.join("render.png");
    write_png(&path, &picture)?;
    let mut drawn = WrittenFiles {
        paths: vec![path],
        notes: vec![format!(
            "render.png shows radiance times {:.4} m² sr/W, {:+.1} stops from the automatic exposure, in sRGB; values above \
             0.8 fade to white",
            exposure.0, shot.stops
        )],
    };
    if let Some(reference) = against {
        let difference = Difference::new(reference, elements, &light);
        let path = folder.join("error.png");
        write_png(&path, &difference.picture(&canvas))?;
        drawn.paths.push(path);
        drawn.notes.push(difference.legend());
    }
    Ok(drawn)
}

/// The view of a shot. Fails if there is no such camera.
fn view(shot: &Shot, scene: &Scene, framing: impl FnOnce() -> View) -> Result<View> {
    let Scene { cameras, file, origin, .. } = scene;
    let view = match &shot.eye {
        Eye::Scene => cameras.first().map_or_else(framing, View::of_camera),
        Eye::Camera(name) => View::of_camera(camera(name, cameras, file)?),
        Eye::Points { from, to, field_of_view } => {
            View::between(*from - *origin, *to - *origin, *field_of_view)
        }
    };
    Ok(match shot.size {
        Some([width, height]) => View { width, height, ..view },
        None => view,
    })
}

/// The camera with this name, or with this number, counting from 1.
fn camera<'a>(name: &str, cameras: &'a [Camera], file: &Path) -> Result<&'a Camera> {
    let by_name = cameras.iter().find(|camera| camera.name == name);
    let by_number = || name.parse::<usize>().ok().and_then(|number| cameras.get(number.checked_sub(1)?));
    by_name.or_else(by_number).ok_or_else(|| {
        let names: Vec<String> = cameras.iter().map(|camera| format!("`{}`", camera.name)).collect();
        let found = if names.is_empty() { "no cameras at all".into() } else { names.join(", ") };
        Error::new(
            file,
            format!("has no camera `{name}`, but {found}"),
            "the name or number of a camera of the scene",
            "choose one of them, or set a viewpoint with --from and --to",
        )
    })
}
