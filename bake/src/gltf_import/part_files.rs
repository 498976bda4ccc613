//! Part files: `"part": "file.glb"` in a node's extras. Each file becomes a draft that merges its contents and,
//! recursively, those of the files it refers to. Each file is read once.

use super::document::Document;
use super::drafts::{Draft, Settings};
use super::files::{Files, file_name};
use super::lights::light;
use super::meshes::Meshes;
use super::nodes::{PlacedNode, roots, subtree};
use super::notes::Notes;
use super::open;
use super::repaint::Asked;
use equilux_formats::{Error, Result};
use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::rc::Rc;

/// The longest chain of part files. Each level could double the surfaces.
const DEEPEST: usize = 16;

/// The files of a scene, with drafts and notes.
pub(super) struct PartFiles {
    pub(super) files: Files,
    pub(super) notes: Notes,
    pub(super) asked: Asked,
    drafts: HashMap<PathBuf, Rc<Draft>>,
    /// The chain of files that are being read, from the scene on.
    chain: Vec<PathBuf>,
}

impl PartFiles {
    /// The files around `scene`.
    pub(super) fn around(scene: &Path) -> Result<Self> {
        let files = Files::around(scene)?;
        Ok(Self {
            files,
            notes: Notes::default(),
            asked: Asked::default(),
            drafts: HashMap::new(),
            chain: Vec::new(),
        })
    }

    /// Reads the document at `path` and adds it to the chain of files.
    pub(super) fn open(&mut self, path: &Path) -> Result<Document> {
        self.chain.push(path.to_path_buf());
        open::read(&mut self.files, path, &mut self.notes)
    }

    /// The draft of the file that `reference` at the node `placed` of the document `from` refers to, and its path.
    pub(super) fn draft(
        &mut self,
        from: &Document,
        placed: &PlacedNode,
        reference: &str,
    ) -> Result<(PathBuf, Rc<Draft>)> {
        if placed.node.mesh().is_some() || placed.node.children().len() > 0 {
            let remark = format!("its own mesh and children are ignored, {reference} stands there");
            self.notes.add(placed.name(), remark);
        }
        let path = self.files.resolve(&from.path, reference, &format!("node {}", placed.name()))?;
        self.check_chain(from, &path)?;
        let draft = match self.drafts.get(&path) {
            Some(draft) => Rc::clone(draft),
            None => self.read(&path)?,
        };
        Ok((path, draft))
    }

    fn check_chain(&self, from: &Document, path: &Path) -> Result<()> {
        let chain = || {
            let names = self.chain.iter().map(PathBuf::as_path).chain([path]).map(file_name);
            names.collect::<Vec<_>>().join(" → ")
        };
        let (found, expected) = match self.chain.iter().any(|open| open == path) {
            true => ("a cycle", "parts that end somewhere".to_owned()),
            false if self.chain.len() > DEEPEST => {
                ("a long chain", format!("at most {DEEPEST} files in a chain"))
            }
            false => return Ok(()),
        };
        let found = format!("{found} of part files: {}", chain());
        Err(from.error(found, expected, "remove one of these part references"))
    }

    fn read(&mut self, path: &Path) -> Result<Rc<Draft>> {
        let document = self.open(path)?;
        let (mut draft, mut meshes) = (Draft::default(), Meshes::of(&document));
        for root in roots(&document, &mut self.notes)? {
            for placed in subtree(&document, root)? {
                self.add(&document, &mut meshes, &mut draft, &placed)?;
            }
        }
        if draft.surfaces.is_empty() {
            return Err(no_surfaces(path));
        }
        let draft = Rc::new(draft);
        self.drafts.insert(path.to_path_buf(), Rc::clone(&draft));
        self.chain.pop();
        Ok(draft)
    }

    fn add(
        &mut self,
        document: &Document,
        meshes: &mut Meshes,
        draft: &mut Draft,
        placed: &PlacedNode,
    ) -> Result<()> {
        draft.settings.hear(Settings::of(&placed.extras), &placed.name(), &mut self.notes);
        if let Some(reference) = &placed.extras.part {
            let (_, part) = self.draft(document, placed, reference)?;
            draft.settings.hear(part.settings, &placed.name(), &mut self.notes);
            self.asked.hear(&placed.look, &part.paints.0);
            for (_, placement) in placed.copies(document)? {
                draft.add_draft(document, &part, placement, (&placed.look, placed.texels))?;
            }
            return Ok(());
        }
        if let Some(mesh) = placed.node.mesh() {
            let mesh = meshes.get(&mesh, &mut self.notes)?;
            self.asked.hear(&placed.look, mesh.primitives.iter().map(|primitive| &primitive.paint));
            for (_, placement) in placed.copies(document)? {
                draft.add_mesh(document, &mesh, placement, (&placed.look, placed.texels))?;
            }
        }
        if let Some(source) = placed.node.light() {
            draft.lights.push(light(document, placed, &source)?);
        }
        if placed.node.camera().is_some() {
            self.notes.add(file_name(&document.path), "cameras in part files are ignored");
        }
        Ok(())
    }
}

/// The error for a file without surfaces.
pub(super) fn no_surfaces(path: &Path) -> Error {
    Error::new(path, "no surfaces", "at least one triangle with an area", "add a mesh to the scene")
}
