//! A scene: parts, instances, cameras, and punctual lights.

use crate::ids::{MaterialId, PartId};
use crate::part::{Material, Part, TexelChoice};
use crate::rgb::Rgb;
use glam::{DAffine3, DVec3};
use std::path::PathBuf;

/// An imported scene. Scene coordinates are those of the file relative to `origin`.
#[derive(Debug, Clone, PartialEq)]
pub struct Scene {
    /// The file's stem.
    pub name: String,
    /// The file it came from.
    pub file: PathBuf,
    /// Every file that was read, the scene's own first: the dependencies for a build tool.
    pub sources: Vec<PathBuf>,
    /// The distinct parts.
    pub parts: Vec<Part>,
    /// The placed parts, in the order of the file's root nodes.
    pub instances: Vec<Instance>,
    /// Cameras, in the order of the file.
    pub cameras: Vec<Camera>,
    /// Lights that are not surfaces.
    pub lights: Vec<PunctualLight>,
    /// The origin of scene coordinates in the file's coordinates, metres: zero, unless the scene is far from the file's origin.
    pub origin: DVec3,
    /// The f32 step of the scene's coordinates in its file, metres: the distance from the largest to the next.
    pub coordinate_step: f64,
    /// Number of closed shells of two-sided surfaces whose inner sides were hidden, because there is no light inside.
    pub hidden_shells: usize,
    /// What the importer ignored, dropped or repaired, one sentence each.
    pub notes: Vec<String>,
}

impl Scene {
    /// Makes normals those of faces everywhere.
    pub fn flatten_normals(&mut self) {
        self.parts.iter_mut().flat_map(|part| &mut part.surfaces).for_each(|surface| surface.normals = None);
    }
}

/// A part placed in a scene.
#[derive(Debug, Clone, PartialEq)]
pub struct Instance {
    /// The root node's name.
    pub name: String,
    /// The part.
    pub part: PartId,
    /// Part coordinates → scene coordinates: a similarity, which may mirror. Other transforms make another part, so
    /// form factors are the same in every instance.
    pub placement: DAffine3,
    /// Factor on the part's emission in this instance (`extras.emission_scale`), by default 1.
    pub emission_scale: f64,
    /// Changed materials of this instance (`extras.materials`).
    pub repainted: Vec<Repainted>,
    /// What its node and those above it choose for its texels.
    pub texels: TexelChoice,
}

/// The changed reflectance and emission of a part's material in one instance.
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
    /// The scale of the placement: metres of the scene for one unit of the part's coordinates.
    pub fn scale(&self) -> f64 {
        self.placement.matrix3.determinant().abs().cbrt()
    }

    /// The part's `materials` as changed by this instance, including the emission scale.
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

/// A perspective camera that looks along −Z with +Y up, as in glTF.
#[derive(Debug, Clone, PartialEq)]
pub struct Camera {
    /// The node's name.
    pub name: String,
    /// Camera coordinates → scene coordinates.
    pub placement: DAffine3,
    /// Vertical field of view, radians.
    pub vertical_fov: f64,
    /// Width over height, if the file has it.
    pub aspect: Option<f64>,
}

/// A light of KHR_lights_punctual.
#[derive(Debug, Clone, PartialEq)]
pub struct PunctualLight {
    /// The node's name.
    pub name: String,
    /// Position, metres.
    pub position: DVec3,
    /// Direction of its light, unit vector.
    pub direction: DVec3,
    /// Linear RGB × intensity: candela for points and spots, lux for directional lights.
    pub intensity: Rgb,
    /// The units of `intensity`, derived from the program that wrote the file.
    pub units: LightUnits,
    /// Which of the extension's three lights it is.
    pub kind: LightKind,
    /// Angular diameter of a directional light, radians; 0 for parallel rays (`extras.angular_diameter`, degrees).
    pub angle: f64,
}

/// The units of the intensities of a file's lights. Radiances of surfaces are W/(m² sr) in all of them.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
#[cfg_attr(feature = "cli", derive(clap::ValueEnum))]
pub enum LightUnits {
    /// W/sr and W/m², numerically equal to glTF's candela and lux
    Radiometric,
    /// Candela and lux at 683 lm/W, as Blender writes by default (lighting mode Standard)
    Photometric,
    /// Total power of lamps in watts, as Blender writes in lighting mode Raw and before version 3.4: W/(4π) for each
    /// sr; W/m² for suns
    BlenderRaw,
}

/// The three lights of KHR_lights_punctual.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum LightKind {
    /// Emits evenly in all directions.
    Point,
    /// Emits in a cone; half angles in radians.
    Spot {
        /// Full intensity up to here.
        inner: f64,
        /// None past here.
        outer: f64,
    },
    /// Parallel rays.
    Directional,
}
