//! Options for a picture from a camera.

use super::assembly::AssemblyOptions;
use super::values;
use crate::outputs::requests::{OutputRequests, Pictures};
use crate::picture::shot::{Eye, Shading, Shot};
use crate::run::job::Job;
use clap::Args;
use glam::DVec3;
use std::path::PathBuf;

/// Options for a picture from a camera.
#[derive(Args)]
pub struct Render {
    #[command(flatten)]
    pub assembly: AssemblyOptions,
    /// The scene's camera with this name, or with this number, counting from 1 [default: the first, or one that shows
    /// the whole scene]
    #[arg(long, value_name = "NAME|N")]
    camera: Option<String>,
    /// Look from this point, metres
    #[arg(long, value_name = "X,Y,Z", value_parser = values::point, allow_hyphen_values = true, requires = "to", conflicts_with = "camera")]
    from: Option<DVec3>,
    /// Look at this point, metres
    #[arg(long, value_name = "X,Y,Z", value_parser = values::point, allow_hyphen_values = true, requires = "from")]
    to: Option<DVec3>,
    /// Vertical field of view of --from, degrees
    #[arg(long, value_name = "DEGREES", default_value = "45", value_parser = values::field_of_view)]
    fov: f64,
    /// Width and height, pixels [default: 720 high, with the camera's aspect ratio]
    #[arg(long, value_name = "WxH", value_parser = values::size)]
    size: Option<[u32; 2]>,
    /// How light is drawn
    #[arg(long, value_name = "HOW", default_value = "smooth")]
    shading: Shading,
    /// Exposure relative to the automatic one, stops
    #[arg(long, value_name = "STOPS", default_value = "0", value_parser = values::stops, allow_hyphen_values = true)]
    exposure: f64,
    /// Also show the difference from the irradiance in this table in false colours: truth.csv of a scene, or a table
    /// written by --elements or --points
    #[arg(long, value_name = "FILE.csv")]
    against: Option<PathBuf>,
}

impl Render {
    /// The job with this picture and no others.
    pub fn job(&self) -> Job {
        let eye = match (&self.camera, self.from, self.to) {
            (Some(name), ..) => Eye::Camera(name.clone()),
            (None, Some(from), Some(to)) => Eye::Points { from, to, field_of_view: self.fov.to_radians() },
            _ => Eye::Scene,
        };
        let shading = self.shading;
        let (size, stops, against) = (self.size, self.exposure, self.against.clone());
        let shot = Some(Shot { eye, size, shading, stops, against });
        let job = self.assembly.job();
        Job { outputs: OutputRequests { shot, pictures: Pictures::None, ..job.outputs }, ..job }
    }
}
