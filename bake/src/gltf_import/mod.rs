//! glTF → [`Scene`]: a `.gltf` or `.glb` file, with the files it refers to, becomes parts of clean surfaces, their
//! instances, cameras and lights, and notes on what was left out. Code outside this module does not depend on glTF.
//!
//! - A part is a root node with all nodes below it. If a single root only wraps others, its children are the parts. Roots
//!   with equal contents are instances of one part.
//! - A node whose extras name a `part` file is an instance of that file's contents.
//! - A node with EXT_mesh_gpu_instancing becomes one instance for each copy.
//! - A part's coordinates start at zero, so that shapes far from the origin keep their digits; placements are
//!   similarities, so that form factors are the same in each instance.
//! - Faulty input is refused with file, finding, expectation and remedy; features that radiosity cannot use are noted.

mod accessors;
mod buffers;
mod coordinates;
mod document;
mod drafts;
mod exporters;
mod extras;
mod files;
mod images;
mod instancing;
mod lights;
mod materials;
mod meshes;
mod nodes;
mod normal_form;
mod notes;
mod open;
mod part_files;
mod parts;
mod repaint;
mod surfaces;
mod triangles;

pub use files::{is_gltf, scenes_in};

use crate::tidy::tidy;
use document::Document;
use drafts::{Draft, Settings, step_after};
use equilux_formats::{Instance, LocalSolver, MaterialId, PartId, Repainted, Result, Scene, TexelChoice};
use glam::{DAffine3, DMat3, DVec3};
use instancing::MOST_COPIES;
use lights::{camera, light, moved};
use materials::Paint;
use meshes::Meshes;
use nodes::{PlacedNode, part_roots, subtree};
use part_files::{PartFiles, no_surfaces};
use parts::{Catalogue, Settled, settle, split};
use repaint::{Look, LookRecipe};
use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::rc::Rc;
use surfaces::Dropped;

/// Reads a scene.
///
/// # Errors
/// The file, or one it refers to, is missing, truncated, inconsistent or not glTF 2.0; requires an unsupported
/// extension; refers to a file outside the scene's folder; has damaged images or reflectances outside 0..1; or the
/// scene has no surfaces.
pub fn import_scene(file: &Path) -> Result<Scene> {
    let mut part_files = PartFiles::around(file)?;
    let document = part_files.open(file)?;
    let mut stage = Stage::new(&document, part_files);
    for root in part_roots(&document, &mut stage.part_files.notes)? {
        stage.add_root(root)?;
    }
    stage.into_scene()
}

/// The scene under construction.
struct Stage<'a> {
    document: &'a Document,
    part_files: PartFiles,
    meshes: Meshes<'a>,
    catalogue: Catalogue,
    /// The parts of earlier recipes; none if all their faces were dropped.
    made: HashMap<Recipe, Option<ImportedPart>>,
    scene: Scene,
}

/// The part made from a recipe.
#[derive(Clone)]
struct ImportedPart {
    part: PartId,
    /// Its origin in the coordinates of its draft.
    start: DVec3,
    /// Its materials, with their names in this recipe.
    paints: Rc<[Paint]>,
    /// The f32 step of the coordinates of its draft, in the draft's unit.
    step: f64,
}

/// The inputs of a part; equal recipes make equal parts. Floats as bits.
#[derive(PartialEq, Eq, Hash)]
struct Recipe {
    file: Option<PathBuf>,
    /// Mesh, placement, look and texels of each node.
    nodes: Vec<(usize, [u64; 12], LookRecipe, TexelRecipe)>,
    settings: (Option<u64>, Option<LocalSolver>),
    linear: [u64; 9],
}

/// The size of texels, and whether there are any.
type TexelRecipe = (Option<u64>, Option<bool>);

/// The contents of a node.
enum Contents<'a> {
    /// Nodes with meshes, in the coordinates of the node.
    Nodes(Vec<PlacedNode<'a>>),
    /// A part file.
    File(PathBuf, Rc<Draft>),
}

impl<'a> Stage<'a> {
    fn new(document: &'a Document, part_files: PartFiles) -> Self {
        let scene = Scene {
            name: document.stem(),
            file: document.path.clone(),
            sources: Vec::new(),
            parts: Vec::new(),
            instances: Vec::new(),
            cameras: Vec::new(),
            lights: Vec::new(),
            origin: DVec3::ZERO,
            coordinate_step: 0.0,
            hidden_shells: 0,
            notes: Vec::new(),
        };
        let meshes = Meshes::of(document);
        Self { document, part_files, meshes, catalogue: Catalogue::default(), made: HashMap::new(), scene }
    }

    fn into_scene(self) -> Result<Scene> {
        if self.scene.instances.is_empty() {
            return Err(no_surfaces(&self.document.path));
        }
        let PartFiles { files, mut notes, asked, .. } = self.part_files;
        asked.note(&mut notes);
        let (sources, notes) = (files.sources, notes.into_sentences());
        let mut scene = Scene { sources, notes, parts: self.catalogue.parts, ..self.scene };
        tidy(&mut scene);
        Ok(scene)
    }

    /// Adds the part of `root`, then everything else below it.
    fn add_root(&mut self, root: PlacedNode<'a>) -> Result<()> {
        let mut own = subtree(self.document, root.as_origin())?;
        own.retain(|placed| placed.extras.part.is_none() && !placed.is_instanced());
        let mut settings = Settings::default();
        own.iter().for_each(|placed| {
            settings.hear(Settings::of(&placed.extras), &placed.name(), &mut self.part_files.notes);
        });
        own.retain(|placed| placed.node.mesh().is_some());
        if !own.is_empty() {
            let at = (root.name(), root.placement);
            self.place((&root.look, root.texels), at, settings, &Contents::Nodes(own))?;
        }
        subtree(self.document, root)?.iter().try_for_each(|placed| self.add_other(placed))
    }

    /// Adds a node that is not a mesh of the root's part: a part file, copies of a mesh, a light, a camera.
    fn add_other(&mut self, placed: &PlacedNode<'a>) -> Result<()> {
        if let Some(reference) = &placed.extras.part {
            let (path, draft) = self.part_files.draft(self.document, placed, reference)?;
            let lights = draft.lights.iter();
            self.scene
                .lights
                .extend(lights.map(|light| moved(light, placed.placement, placed.look.emission_scale)));
            let settings = Settings::of(&placed.extras).or(draft.settings);
            self.place_copies(placed, settings, &Contents::File(path, draft))?;
        } else if placed.is_instanced() && placed.node.mesh().is_some() {
            let contents = Contents::Nodes(vec![placed.as_origin()]);
            self.place_copies(placed, Settings::of(&placed.extras), &contents)?;
        }
        if let Some(source) = placed.node.light() {
            self.scene.lights.push(light(self.document, placed, &source)?);
        }
        self.scene.cameras.extend(camera(self.document, placed, &mut self.part_files.notes)?);
        Ok(())
    }

    fn place_copies(
        &mut self,
        placed: &PlacedNode<'a>,
        settings: Settings,
        contents: &Contents<'a>,
    ) -> Result<()> {
        let copies = placed.copies(self.document)?;
        if self.scene.instances.len() + copies.len() > MOST_COPIES {
            return Err(self.document.error(
                format!("more than {MOST_COPIES} instances"),
                "fewer",
                "join copies to larger parts",
            ));
        }
        copies
            .into_iter()
            .try_for_each(|at| self.place((&placed.look, placed.texels), at, settings, contents))
    }

    /// Adds the instance of this name and placement.
    fn place(
        &mut self,
        (look, texels): (&Look, TexelChoice),
        (name, placement): (String, DAffine3),
        settings: Settings,
        contents: &Contents<'a>,
    ) -> Result<()> {
        let root = placement;
        let (linear, placement) = split(placement);
        let recipe = recipe(contents, settings, linear);
        let made = match self.made.get(&recipe) {
            Some(made) => made.clone(),
            None => {
                let made = self.make(&name, settings, contents, linear)?;
                self.made.insert(recipe, made.clone());
                made
            }
        };
        let Some(ImportedPart { part, start, paints, step }) = made else { return Ok(()) };
        self.scene.coordinate_step = self.scene.coordinate_step.max(step_after(step, root));
        self.part_files.asked.hear(look, &*paints);
        self.scene.instances.push(Instance {
            name,
            part,
            placement: placement * DAffine3::from_translation(start),
            emission_scale: look.emission_scale,
            repainted: repainted(look, &paints),
            texels,
        });
        Ok(())
    }

    fn make(
        &mut self,
        instance: &str,
        settings: Settings,
        contents: &Contents<'a>,
        linear: DMat3,
    ) -> Result<Option<ImportedPart>> {
        let (name, draft) = match contents {
            Contents::Nodes(nodes) => (instance.to_owned(), Rc::new(self.draft(nodes)?)),
            Contents::File(path, draft) => {
                (path.file_stem().unwrap_or_default().to_string_lossy().into_owned(), Rc::clone(draft))
            }
        };
        let Settled { part, paints, start, dropped } = settle(&draft, linear, settings, name.clone());
        if part.surfaces.is_empty() {
            self.part_files.notes.add(instance, "left out, none of its faces has an area");
            return Ok(None);
        }
        let known = self.catalogue.parts.len();
        let id = self.catalogue.id(part);
        if id.index() == known && dropped != Dropped::default() {
            self.part_files.notes.add(name, remark(dropped));
        }
        Ok(Some(ImportedPart { part: id, start, paints: paints.into(), step: draft.step }))
    }

    fn draft(&mut self, nodes: &[PlacedNode<'a>]) -> Result<Draft> {
        let mut draft = Draft::default();
        for placed in nodes {
            let Some(mesh) = placed.node.mesh() else { continue };
            let mesh = self.meshes.get(&mesh, &mut self.part_files.notes)?;
            self.part_files
                .asked
                .hear(&placed.look, mesh.primitives.iter().map(|primitive| &primitive.paint));
            draft.add_mesh(self.document, &mesh, placed.placement, (&placed.look, placed.texels))?;
        }
        Ok(draft)
    }
}

fn recipe(contents: &Contents, settings: Settings, linear: DMat3) -> Recipe {
    let mesh = |placed: &PlacedNode| {
        let index = placed.node.mesh().map_or(usize::MAX, |mesh| mesh.index());
        let texels = (placed.texels.size.map(f64::to_bits), placed.texels.any);
        (index, placed.placement.to_cols_array().map(f64::to_bits), placed.look.recipe(), texels)
    };
    let (file, nodes) = match contents {
        Contents::Nodes(nodes) => (None, nodes.iter().map(mesh).collect()),
        Contents::File(path, _) => (Some(path.clone()), Vec::new()),
    };
    Recipe {
        file,
        nodes,
        settings: (settings.element_size.map(f64::to_bits), settings.local_solver),
        linear: linear.to_cols_array().map(f64::to_bits),
    }
}

/// The repainted materials, without emission scales.
fn repainted(look: &Look, paints: &[Paint]) -> Vec<Repainted> {
    let repainted = |(number, paint): (usize, &Paint)| {
        let new = look.repainted(paint);
        let (old, new) = (paint.material(), new.material());
        let differs = (old.reflectance, old.emission) != (new.reflectance, new.emission);
        let material = MaterialId::from_index(number);
        differs.then_some(Repainted { material, reflectance: new.reflectance, emission: new.emission })
    };
    paints.iter().enumerate().filter_map(repainted).collect()
}

fn remark(dropped: Dropped) -> String {
    let count = |count: usize, what: &str, rest: &str| {
        let plural = if count == 1 { "" } else { "s" };
        (count > 0).then(|| format!("{count} {what}{plural}{rest}"))
    };
    let counts = [
        count(dropped.without_area, "face", " without area"),
        count(dropped.duplicates, "duplicate face", ""),
    ];
    format!("dropped {}", counts.into_iter().flatten().collect::<Vec<_>>().join(" and "))
}
