//! Drafts of parts: the surfaces of all nodes below a root, in one coordinate system.

use super::document::Document;
use super::extras::Extras;
use super::lights::moved;
use super::materials::Paint;
use super::meshes::Mesh;
use super::notes::Notes;
use super::repaint::Look;
use super::surfaces::{Dropped, f32_spacing};
use equilux_formats::texture::TexturedTriangle;
use equilux_formats::{LocalSolver, MaterialId, PunctualLight, Result, Surface, TexelChoice};
use glam::{DAffine3, DVec3};

/// The largest number of surfaces of a part: a few kilobytes of nodes that share a mesh could produce any number.
const MOST_SURFACES: usize = 1 << 24;

/// The settings of a part as a whole.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(super) struct Settings {
    /// Element size, metres.
    pub(super) element_size: Option<f64>,
    /// The solver of the local equilibrium.
    pub(super) local_solver: Option<LocalSolver>,
}

impl Settings {
    /// The settings in `extras`.
    pub(super) fn of(extras: &Extras) -> Self {
        Self { element_size: extras.element_size, local_solver: extras.local_solver }
    }

    /// These settings, completed by those of `other`.
    pub(super) fn or(self, other: Self) -> Self {
        Self {
            element_size: self.element_size.or(other.element_size),
            local_solver: self.local_solver.or(other.local_solver),
        }
    }

    /// Adds the settings of the node called `name`. The first node with a setting decides for the part.
    pub(super) fn hear(&mut self, asked: Self, name: &str, notes: &mut Notes) {
        let together = self.or(asked);
        if asked.or(together) != together {
            notes.add(name, "its element_size or local_solver differs from the part's, which holds");
        }
        *self = together;
    }
}

/// Surfaces, materials and lights in the coordinates of a root node or of a file.
#[derive(Default)]
pub(super) struct Draft {
    pub(super) surfaces: Vec<Surface>,
    pub(super) textured: Vec<TexturedTriangle>,
    pub(super) paints: Paints,
    pub(super) lights: Vec<PunctualLight>,
    pub(super) settings: Settings,
    pub(super) dropped: Dropped,
    /// The f32 step of its coordinates in the file, in its own unit.
    pub(super) step: f64,
}

/// The f32 step `step` of coordinates after `placement`.
pub(super) fn step_after(step: f64, placement: DAffine3) -> f64 {
    let DAffine3 { matrix3, translation } = placement;
    let scale =
        [matrix3.x_axis, matrix3.y_axis, matrix3.z_axis].map(DVec3::length).into_iter().fold(0.0, f64::max);
    (step * scale).max(f32_spacing(translation.abs().max_element()))
}

impl Draft {
    /// Adds `mesh`, placed by `placement` and repainted by `look`, with these `texels`.
    pub(super) fn add_mesh(
        &mut self,
        document: &Document,
        mesh: &Mesh,
        placement: DAffine3,
        (look, texels): (&Look, TexelChoice),
    ) -> Result<()> {
        for primitive in &mesh.primitives {
            let material = self.paints.id(look.on(&primitive.paint));
            let surfaces = primitive.surfaces.iter().map(|surface| Surface { material, texels, ..*surface });
            self.add(document, surfaces, placement)?;
            self.add_textured(&primitive.textured, |_| material, placement);
        }
        self.dropped += mesh.dropped;
        self.step = self.step.max(step_after(mesh.step, placement));
        Ok(())
    }

    /// Adds all of `other`, placed by `placement` and repainted by `look`, with these `texels` where it chooses none itself.
    pub(super) fn add_draft(
        &mut self,
        document: &Document,
        other: &Draft,
        placement: DAffine3,
        (look, texels): (&Look, TexelChoice),
    ) -> Result<()> {
        let materials: Vec<MaterialId> =
            other.paints.0.iter().map(|paint| self.paints.id(look.on(paint))).collect();
        let surfaces = other.surfaces.iter();
        let surfaces = surfaces.map(|s| Surface {
            material: materials[s.material.index()],
            texels: s.texels.or(texels),
            ..*s
        });
        self.add(document, surfaces, placement)?;
        self.add_textured(&other.textured, |old| materials[old.index()], placement);
        self.lights.extend(other.lights.iter().map(|light| moved(light, placement, look.emission_scale)));
        self.dropped += other.dropped;
        self.step = self.step.max(step_after(other.step, placement));
        Ok(())
    }

    fn add_textured(
        &mut self,
        triangles: &[TexturedTriangle],
        material: impl Fn(MaterialId) -> MaterialId,
        placement: DAffine3,
    ) {
        let placed =
            |t: &TexturedTriangle| TexturedTriangle { material: material(t.material), ..t.placed(placement) };
        self.textured.extend(triangles.iter().map(placed));
    }

    fn add(
        &mut self,
        document: &Document,
        surfaces: impl ExactSizeIterator<Item = Surface>,
        placement: DAffine3,
    ) -> Result<()> {
        if self.surfaces.len() + surfaces.len() > MOST_SURFACES {
            return Err(document.error(
                format!("a part of more than {MOST_SURFACES} surfaces"),
                "fewer",
                "divide it into several root nodes, or simplify its meshes",
            ));
        }
        self.surfaces.extend(surfaces.map(|surface| surface.placed(placement)));
        Ok(())
    }
}

/// Distinct paints. Equal paints of different names stay distinct: each may be repainted by its name, which must not
/// change elements.
#[derive(Debug, Clone, Default)]
pub(super) struct Paints(pub(super) Vec<Paint>);

impl Paints {
    /// The id of `paint`.
    pub(super) fn id(&mut self, paint: Paint) -> MaterialId {
        let known = self.0.iter().position(|known| *known == paint);
        MaterialId::from_index(known.unwrap_or_else(|| {
            self.0.push(paint);
            self.0.len() - 1
        }))
    }
}
