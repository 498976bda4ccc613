//! A scene: parts, where they stand, who looks, and what lights are not surfaces.

use crate::ids::{MaterialId, PartId};
use crate::part::{Material, Part};
use crate::rgb::Rgb;
use glam::{DAffine3, DVec3};
use std::path::PathBuf;

/// Parts and their instances, as the importer found them. Scene coordinates are the file's, moved by `origin`.
#[derive(Debug, Clone, PartialEq)]
pub struct Scene {
    /// The file's stem.
    pub name: String,
    /// The file it came from.
    pub file: PathBuf,
    /// Every file that was read, the scene's own first: what a build tool must watch.
    pub sources: Vec<PathBuf>,
    /// The distinct parts.
    pub parts: Vec<Part>,
    /// The placed parts, in the order of the file's root nodes.
    pub instances: Vec<Instance>,
    /// Cameras, in the order of the file.
    pub cameras: Vec<Camera>,
    /// Lights that are not surfaces.
    pub lights: Vec<PunctualLight>,
    /// Where the origin of scene coordinates lies in the file's coordinates, metres: zero, unless the scene is far from there.
    pub origin: DVec3,
    /// What f32 leaves undecided of the scene's coordinates in its file, metres: the distance from the largest to the next.
    pub coordinate_step: f64,
    /// Number of closed shells of two-sided surfaces whose inner sides were hidden, as nothing shines inside.
    pub hidden_shells: usize,
    /// What was ignored, dropped or repaired on the way in, one sentence each.
    pub notes: Vec<String>,
}

/// A part placed in a scene.
#[derive(Debug, Clone, PartialEq)]
pub struct Instance {
    /// The root node's name.
    pub name: String,
    /// The part that stands there.
    pub part: PartId,
    /// Part coordinates → scene coordinates: a rotation, perhaps mirrored, uniformly scaled, and moved. Anything else
    /// is another part, so form factors are the same in every instance.
    pub placement: DAffine3,
    /// Factor on the part's emission in this place (`extras.emission_scale`), 1 unless told.
    pub emission_scale: f64,
    /// What the part's materials do with light in this place, where that is told (`extras.materials`).
    pub repainted: Vec<Repainted>,
}

/// What a material of a part does with light in one place.
#[derive(Debug, Clone, PartialEq)]
pub struct Repainted {
    /// The material.
    pub material: MaterialId,
    /// Diffuse reflectance ρ, 0..1, linear RGB.
    pub reflectance: Rgb,
    /// Emission, W/m², linear RGB, before the instance's emission scale.
    pub emission: Rgb,
}

impl Instance {
    /// The factor of the placement on lengths: so many metres of the scene are one unit of the part's coordinates.
    pub fn scale(&self) -> f64 {
        self.placement.matrix3.determinant().abs().cbrt()
    }

    /// The part's `materials` as they are in this place, emission scale included.
    pub fn materials(&self, materials: &[Material]) -> Vec<Material> {
        let mut here = materials.to_vec();
        for Repainted { material, reflectance, emission } in &self.repainted {
            let material = &mut here[material.index()];
            (material.reflectance, material.emission) = (*reflectance, *emission);
        }
        here.iter_mut().for_each(|material| material.emission = material.emission * self.emission_scale);
        here
    }
}

/// A perspective camera that looks along −Z with +Y up, as glTF has it.
#[derive(Debug, Clone, PartialEq)]
pub struct Camera {
    /// The node's name.
    pub name: String,
    /// Camera coordinates → scene coordinates.
    pub placement: DAffine3,
    /// Vertical field of view, radians.
    pub vertical_fov: f64,
    /// Width over height, where the file gives one.
    pub aspect: Option<f64>,
}

/// A light of KHR_lights_punctual.
#[derive(Debug, Clone, PartialEq)]
pub struct PunctualLight {
    /// The node's name.
    pub name: String,
    /// Where it stands, metres.
    pub position: DVec3,
    /// Where it shines to, unit.
    pub direction: DVec3,
    /// Linear RGB × intensity: candela for points and spots, lux for directional lights.
    pub intensity: Rgb,
    /// What these numbers mean, as far as the file tells by naming the program that wrote it.
    pub units: LightUnits,
    /// Which of the extension's three lights it is.
    pub kind: LightKind,
    /// How wide a directional light looks, radians; 0 for parallel rays (`extras.angular_diameter`, degrees).
    pub angle: f64,
}

/// The units of the intensities of a file's lights. Radiances of surfaces are W/(m² sr) in all of them.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
#[cfg_attr(feature = "cli", derive(clap::ValueEnum))]
pub enum LightUnits {
    /// W/sr and W/m², number for number what glTF calls candela and lux
    Radiometric,
    /// Candela and lux of light of 683 lm/W, as Blender writes by default (lighting mode Standard)
    Photometric,
    /// Watts of whole lamps, as Blender writes in lighting mode Raw, and did before version 3.4: W/(4π) to each sr; W/m² of
    /// suns
    BlenderRaw,
}

/// The three lights of KHR_lights_punctual.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum LightKind {
    /// Shines evenly to all sides.
    Point,
    /// Shines in a cone; half angles in radians.
    Spot {
        /// Full intensity up to here.
        inner: f64,
        /// None past here.
        outer: f64,
    },
    /// Parallel rays.
    Directional,
}
