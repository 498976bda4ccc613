//! Imports meshes, each once however often it is placed: surfaces in mesh coordinates and the material of each primitive.

use super::document::Document;
use super::images::Textures;
use super::materials::{Paint, Uses, paint};
use super::notes::Notes;
use super::surfaces::{Dropped, surfaces};
use super::triangles::triangles;
use equilux_formats::texture::TexturedTriangle;
use equilux_formats::{Result, Surface};
use std::collections::HashMap;
use std::rc::Rc;

/// A mesh in its own coordinates.
#[derive(Default)]
pub(super) struct Mesh {
    /// Its primitives.
    pub(super) primitives: Vec<Primitive>,
    /// The dropped faces.
    pub(super) dropped: Dropped,
    /// The rounding step of its largest coordinate, in its own unit.
    pub(super) step: f64,
}

/// A primitive: surfaces of one paint. All refer to material 0 until a part numbers its paints.
pub(super) struct Primitive {
    pub(super) surfaces: Vec<Surface>,
    /// Textured triangles, if colours vary over them.
    pub(super) textured: Vec<TexturedTriangle>,
    pub(super) paint: Paint,
}

/// The meshes of one document.
pub(super) struct Meshes<'a> {
    document: &'a Document,
    read: HashMap<usize, Rc<Mesh>>,
    textures: Textures,
}

impl<'a> Meshes<'a> {
    /// The meshes of `document`, none of which is read yet.
    pub(super) fn of(document: &'a Document) -> Self {
        Self { document, read: HashMap::new(), textures: Textures::default() }
    }

    /// The mesh `source` of the document, read on first use.
    pub(super) fn get(&mut self, source: &gltf::Mesh, notes: &mut Notes) -> Result<Rc<Mesh>> {
        if let Some(mesh) = self.read.get(&source.index()) {
            return Ok(Rc::clone(mesh));
        }
        let mesh = Rc::new(read_mesh(self.document, source, &mut self.textures, notes)?);
        self.read.insert(source.index(), Rc::clone(&mesh));
        Ok(mesh)
    }
}

fn read_mesh(
    document: &Document,
    source: &gltf::Mesh,
    textures: &mut Textures,
    notes: &mut Notes,
) -> Result<Mesh> {
    let name = source.name().map_or_else(|| source.index().to_string(), str::to_owned);
    let subject = format!("mesh {name}");
    let mut mesh = Mesh::default();
    for primitive in source.primitives() {
        let uses = Uses::of(&primitive.material());
        let Some(mut triangles) = triangles(document, &primitive, &uses, &name)? else {
            notes.add(&subject, "points and lines are ignored, they have no area");
            continue;
        };
        if triangles.left_over > 0 {
            notes.add(&subject, "its last one or two corners make no triangle and are ignored");
        }
        if primitive.material().index().is_none() {
            notes.add(&subject, "no material, so white with reflectance 1 as glTF has it");
        }
        if [uses.reflectance, uses.emission].iter().flatten().any(|of| !of.is_served_by(&primitive)) {
            notes.add(&subject, "a texture without coordinates on the mesh is ignored");
        }
        if triangles.lightmap.iter().flatten().flatten().any(|place| !place.is_finite()) {
            notes.add(&subject, "TEXCOORD_1 with numbers that are not finite is ignored");
            triangles.lightmap = None;
        }
        let surfaces = surfaces(&triangles);
        mesh.step = mesh.step.max(surfaces.step);
        mesh.dropped += surfaces.dropped;
        let paint = paint(document, &primitive.material(), textures, notes)?;
        let (surfaces, textured) = (surfaces.kept, surfaces.textured);
        mesh.primitives.push(Primitive { surfaces, textured, paint });
    }
    Ok(mesh)
}
