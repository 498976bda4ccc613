//! Prepares the parts of a scene for baking: cuts them into elements of the chosen size, or divides the whole scene
//! into cells by planes.

use crate::elements::bisect::{Cut, bisect, cut_all};
use crate::elements::clusters;
use crate::elements::patches::patches;
use crate::elements::{ElementSize, Panels, area, default_size, optics};
use crate::equilibrium::default_solver;
use crate::textures::tints;
use crate::treecode::{EXACT, Resolution, rays_for_tolerance};
use crate::world::World;
use equilux_formats::texture::TexturedTriangle;
use equilux_formats::{
    Element, Error, Geometry, Instance, LocalSolver, Material, MaterialId, Optics, Part, PartId, Result,
    Scene, TexelChoice, Tints,
};
use glam::DAffine3;

/// The settings for elements and parts.
#[derive(Debug, Clone, PartialEq)]
pub struct Preparation {
    /// Element size, metres of the scene where a part stands largest; none to let the scene decide. A part's own
    /// `element_size` comes first.
    pub element_size: Option<ElementSize>,
    /// How the scene is divided into parts.
    pub division: Division,
    /// The resolution of exact form factors.
    pub resolution: Resolution,
    /// How rows are computed.
    pub rows: RowMethod,
    /// Rays a row, where rows are counted rays: a multiple of 64.
    pub rays: u32,
    /// Local solver; none to let the part's size decide. A part's own `local_solver` comes first.
    pub local_solver: Option<LocalSolver>,
}

impl Default for Preparation {
    /// The default of the command line.
    fn default() -> Self {
        Self {
            element_size: None,
            division: Division::Authored,
            resolution: Resolution::for_tolerance(TOLERANCE),
            rows: RowMethod::Auto,
            rays: rays_for_tolerance(TOLERANCE),
            local_solver: None,
        }
    }
}

/// The default tolerance of form factors, a share of the mean light.
pub const TOLERANCE: f64 = 0.01;

/// How rows of form factors are computed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "cli", derive(clap::ValueEnum))]
pub enum RowMethod {
    /// Exact rows with --tolerance 0, otherwise rays
    #[default]
    Auto,
    /// Exact form factors at the centre of each element; the cost of a row grows with the faces in view
    Exact,
    /// A hemisphere of rays from each element; the cost of a row depends on their number
    Rays,
}

impl Preparation {
    /// The resolution of form factors, and whether rows are counted rays.
    fn resolution(&self) -> Resolution {
        let by_rays = match self.rows {
            RowMethod::Auto => self.resolution != EXACT,
            RowMethod::Exact => false,
            RowMethod::Rays => true,
        };
        Resolution { rays: by_rays.then_some(self.rays), ..self.resolution }
    }

    /// How rows are computed, and why.
    pub fn rows_text(&self) -> String {
        let why = match self.rows {
            RowMethod::Auto if self.resolution == EXACT => "with --tolerance 0",
            RowMethod::Auto => "unless --tolerance is 0",
            RowMethod::Exact | RowMethod::Rays => "as --rows asks",
        };
        match self.resolution().rays {
            Some(rays) => format!("{rays} rays each, {why}"),
            None => format!("exact, {why}"),
        }
    }
}

/// How a scene is divided into parts.
#[derive(Debug, Clone, PartialEq)]
pub enum Division {
    /// By the scene's root nodes.
    Authored,
    /// Into this many cells: repeatedly halves the largest at the median of its longest axis.
    Bisect(usize),
    /// Into the cells between these planes.
    Cuts(Vec<Cut>),
}

/// A scene whose parts have elements.
#[derive(Debug)]
pub struct Prepared {
    /// The distinct parts.
    pub parts: Vec<PreparedPart>,
    /// The parts placed.
    pub instances: Vec<Instance>,
    /// The element size of parts without one of their own.
    pub element_size: ElementSize,
    /// The resolution of form factors, and whether rows are counted rays.
    pub resolution: Resolution,
}

impl Prepared {
    /// Number of elements of the scene.
    pub fn elements(&self) -> usize {
        self.instances.iter().map(|instance| self.parts[instance.part.index()].geometry.elements.len()).sum()
    }

    /// Number of unknowns of the scene: elements, or patches of them.
    pub fn unknowns(&self) -> usize {
        let unknowns = |instance: &Instance| self.parts[instance.part.index()].geometry.unknowns().elements();
        self.instances.iter().map(unknowns).sum()
    }
}

/// A part that is ready to bake.
#[derive(Debug)]
pub struct PreparedPart {
    /// Its name.
    pub name: String,
    /// Elements and faces.
    pub geometry: Geometry,
    /// Reflectance and emission of the elements.
    pub optics: Optics,
    /// The factors that textures multiply these by, one row an element.
    pub tints: Tints,
    /// The materials that elements name.
    pub materials: Vec<Material>,
    /// How large its elements may be, metres of the scene where it stands largest.
    pub element_size: ElementSize,
    /// The metres that one unit of its coordinates makes there.
    pub unit: f64,
    /// The solver of its local equilibrium.
    pub solver: LocalSolver,
}

/// The largest number of elements of a part: ids are 32 bits, and no machine holds a matrix of this many rows.
const MOST_ELEMENTS: u128 = 4_000_000;

/// Cuts every part into elements. Fails if the element size gives a part more than 4 million of them, or if f32
/// coordinates are too coarse.
pub fn prepare(scene: &Scene, wanted: &Preparation) -> Result<Prepared> {
    let scales = largest_scales(scene);
    let element_size = wanted.element_size.unwrap_or_else(|| suitable_size(scene, &scales));
    refuse_lost_digits(scene, element_size, &scales)?;
    let resolution = wanted.resolution();
    let mut parts = Vec::new();
    for (part, &scale) in scene.parts.iter().zip(&scales) {
        let size = part.element_size.map_or(element_size, ElementSize::Metres);
        let panels = Panels::of(part, size.in_units_of(scale));
        refuse_too_many(scene, part, panels.elements(), size)?;
        let mut geometry = panels.geometry();
        geometry.patches =
            resolution.rays.map(|rays| patches(&geometry.elements, size.in_units_of(scale), rays));
        let tints = tints(&geometry, &part.materials, &part.textured);
        let solver = part.local_solver.or(wanted.local_solver);
        parts.push(PreparedPart {
            name: part.name.clone(),
            optics: optics(&geometry, &part.materials, &tints),
            tints,
            solver: solver.unwrap_or_else(|| default_solver(geometry.unknowns().elements())),
            materials: part.materials.clone(),
            element_size: size,
            unit: scale,
            geometry,
        });
    }
    let authored = Prepared { parts, instances: scene.instances.clone(), element_size, resolution };
    Ok(match &wanted.division {
        Division::Authored => authored,
        Division::Bisect(count) => divided(&authored, wanted, scene, |whole| bisect(whole, *count)),
        Division::Cuts(planes) => {
            let here = |cut: &Cut| Cut { offset: cut.offset - scene.origin[cut.axis], ..*cut };
            let planes: Vec<Cut> = planes.iter().map(here).collect();
            divided(&authored, wanted, scene, |whole| cut_all(whole, &planes))
        }
    })
}

/// For each part the metres of the scene that one of its own units makes where it stands largest. Element sizes hold there;
/// smaller instances share its elements.
fn largest_scales(scene: &Scene) -> Vec<f64> {
    let mut scales = vec![0.0; scene.parts.len()];
    for instance in &scene.instances {
        let scale: &mut f64 = &mut scales[instance.part.index()];
        *scale = scale.max(instance.scale());
    }
    scales
}

/// A size for about the usual number of elements in all instances.
fn suitable_size(scene: &Scene, scales: &[f64]) -> ElementSize {
    default_size(placed_area(scene, scales))
}

/// The area of all instances, each as large as the largest of its part, m².
fn placed_area(scene: &Scene, scales: &[f64]) -> f64 {
    let parts = scene.instances.iter().map(|instance| instance.part.index());
    parts.map(|part| area(&scene.parts[part]) * scales[part].powi(2)).sum()
}

/// Coordinate steps of f32 above this share of the element size are noted.
const NOTED_STEP: f64 = 0.01;

/// Refuses a scene whose f32 coordinates are coarser than its elements.
fn refuse_lost_digits(scene: &Scene, size: ElementSize, scales: &[f64]) -> Result<()> {
    let metres = match size {
        ElementSize::Metres(metres) => metres,
        ElementSize::Mesh => {
            let faces: usize =
                scene.instances.iter().map(|i| scene.parts[i.part.index()].surfaces.len()).sum();
            (placed_area(scene, scales) / faces as f64).sqrt()
        }
    };
    if scene.coordinate_step <= metres {
        return Ok(());
    }
    Err(Error::new(
        &scene.file,
        format!("coordinates so large that f32 represents them in steps of {} m", scene.coordinate_step),
        format!("at most the size of elements, {metres} m"),
        "move the scene close to the origin",
    ))
}

/// A note, if the f32 rounding of the scene's coordinates distorts elements of this size noticeably.
pub fn lost_digits_note(scene: &Scene, size: ElementSize) -> Option<String> {
    let ElementSize::Metres(metres) = size else { return None };
    (scene.coordinate_step > NOTED_STEP * metres).then(|| {
        format!(
            "coordinates are so large that f32 represents them in steps of {:.1e} m, with elements of {size}: shapes and \
             places are rounded; move the scene close to the origin",
            scene.coordinate_step
        )
    })
}

fn refuse_too_many(scene: &Scene, part: &Part, elements: u128, size: ElementSize) -> Result<()> {
    if elements <= MOST_ELEMENTS {
        return Ok(());
    }
    let found = match size {
        ElementSize::Metres(size) => {
            format!("part `{}` in elements of {size} m has {elements} of them", part.name)
        }
        ElementSize::Mesh => format!("part `{}` with {elements} faces", part.name),
    };
    let remedy = if part.surfaces.len() as u128 > MOST_ELEMENTS {
        "simplify its mesh, or divide it into several root nodes"
    } else if part.element_size.is_some() {
        "choose a larger element_size in the extras of its node"
    } else {
        "choose larger elements with --element-size METRES"
    };
    Err(Error::new(&scene.file, found, format!("at most {MOST_ELEMENTS:e} elements a part"), remedy))
}

/// Merges the scene into one geometry and divides it into cells; each cell is a part with one instance.
fn divided(
    authored: &Prepared,
    wanted: &Preparation,
    scene: &Scene,
    divide: impl FnOnce(Geometry) -> Vec<Geometry>,
) -> Prepared {
    let MergedScene { whole, materials, textured } = merged(authored, scene);
    let (mut parts, mut instances) = (Vec::new(), Vec::new());
    for (number, cell) in divide(whole).into_iter().enumerate() {
        let name = format!("cell {}", number + 1);
        let tints = tints(&cell, &materials, &textured);
        // Cells keep the coordinates of the whole, so that all of them round alike and have the same rays.
        let rays = authored.resolution.rays;
        let patches = rays.map(|rays| patches(&cell.elements, authored.element_size, rays));
        let geometry = Geometry { patches, ..cell };
        instances.push(Instance {
            name: name.clone(),
            part: PartId::from_index(number),
            placement: DAffine3::IDENTITY,
            emission_scale: 1.0,
            repainted: vec![],
            texels: TexelChoice::default(),
        });
        let solver = wanted.local_solver.unwrap_or_else(|| default_solver(geometry.unknowns().elements()));
        parts.push(PreparedPart {
            name,
            optics: optics(&geometry, &materials, &tints),
            tints,
            geometry,
            materials: materials.clone(),
            element_size: authored.element_size,
            unit: 1.0,
            solver,
        });
    }
    Prepared { parts, instances, element_size: authored.element_size, resolution: authored.resolution }
}

/// All instances in scene coordinates, with one list of materials, as each instance has them.
struct MergedScene {
    whole: Geometry,
    materials: Vec<Material>,
    textured: Vec<TexturedTriangle>,
}

fn merged(prepared: &Prepared, scene: &Scene) -> MergedScene {
    let part = |instance: &Instance| &prepared.parts[instance.part.index()];
    let world = World::new(prepared.instances.iter().map(|i| (&part(i).geometry, i.placement)));
    let mut materials: Vec<Material> = Vec::new();
    let (mut elements, mut textured) = (Vec::new(), Vec::new());
    for (number, instance) in prepared.instances.iter().enumerate() {
        let here = instance.materials(&part(instance).materials);
        let own: Vec<MaterialId> = here.into_iter().map(|m| number_of(&mut materials, m)).collect();
        let placed = world.elements[world.elements_of(number)].iter();
        elements.extend(placed.map(|e| Element { material: own[e.material.index()], ..*e }));
        textured.extend(scene.parts[instance.part.index()].textured.iter().map(|triangle| {
            let material = own[triangle.material.index()];
            TexturedTriangle { material, ..triangle.placed(instance.placement) }
        }));
    }
    MergedScene { whole: clusters::geometry(elements, world.faces), materials, textured }
}

fn number_of(materials: &mut Vec<Material>, material: Material) -> MaterialId {
    let known = materials.iter().position(|m| *m == material);
    MaterialId::from_index(known.unwrap_or_else(|| {
        materials.push(material);
        materials.len() - 1
    }))
}
