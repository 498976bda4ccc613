//! Material changes in a node's extras, for everything below the node: `emission_scale`, and `materials` by name.
//! Applies them to paints, and notes names without a material.

use super::materials::Paint;
use super::notes::Notes;
use serde::Deserialize;
use serde_json::Value;
use std::collections::BTreeMap;
use std::rc::Rc;

/// Changes, by name of the material.
pub(super) type Changes = BTreeMap<String, MaterialChange>;

/// Changes of one material; missing properties stay.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(rename_all = "camelCase", deny_unknown_fields)]
pub(super) struct MaterialChange {
    base_color_factor: Option<[f64; 4]>,
    emissive_factor: Option<[f64; 3]>,
    emissive_strength: Option<f64>,
}

/// Parses the changes in `value` of the extras; none if they are invalid.
pub(super) fn changes(value: &Value) -> Option<Changes> {
    let changes: Changes = serde_json::from_value(value.clone()).ok()?;
    changes.values().all(MaterialChange::is_possible).then_some(changes)
}

impl MaterialChange {
    fn is_possible(&self) -> bool {
        let light = |value: &f64| value.is_finite() && *value >= 0.0;
        self.base_color_factor.iter().flatten().all(|rho| (0.0..=1.0).contains(rho))
            && self.emissive_factor.iter().flatten().chain(&self.emissive_strength).all(light)
    }

    fn on(&self, mut paint: Paint) -> Paint {
        paint.base_colour = self.base_color_factor.unwrap_or(paint.base_colour);
        paint.emissive_factor = self.emissive_factor.unwrap_or(paint.emissive_factor);
        paint.emissive_strength = self.emissive_strength.unwrap_or(paint.emissive_strength);
        paint
    }
}

/// The changes of one node.
#[derive(Debug)]
pub(super) struct Repaint {
    /// The node's number in its file.
    node: usize,
    /// The name of the node.
    name: String,
    changes: Changes,
}

impl Repaint {
    /// The changes of `node`, called `name`.
    pub(super) fn new(node: &gltf::Node, name: String, changes: &Changes) -> Self {
        Self { node: node.index(), name, changes: changes.clone() }
    }
}

/// The combined changes of a chain of nodes to the materials below them.
#[derive(Debug, Clone)]
pub(super) struct Look {
    /// Product of their emission scales.
    pub(super) emission_scale: f64,
    /// Their repaints, from the first node downwards; the last one that names a property decides.
    pub(super) repaints: Vec<Rc<Repaint>>,
}

impl Default for Look {
    /// Nothing changes.
    fn default() -> Self {
        Self { emission_scale: 1.0, repaints: Vec::new() }
    }
}

impl Look {
    /// `paint` with everything changed.
    pub(super) fn on(&self, paint: &Paint) -> Paint {
        let repainted = self.repainted(paint);
        Paint { emissive_strength: repainted.emissive_strength * self.emission_scale, ..repainted }
    }

    /// `paint` with everything but the emission scale.
    pub(super) fn repainted(&self, paint: &Paint) -> Paint {
        let changes = self.repaints.iter().filter_map(|repaint| repaint.changes.get(&paint.name));
        changes.fold(paint.clone(), |paint, change| change.on(paint))
    }

    /// A key that distinguishes looks in one file.
    pub(super) fn recipe(&self) -> LookRecipe {
        let repaints = self.repaints.iter().map(|repaint| repaint.node).collect();
        LookRecipe { emission_scale: self.emission_scale.to_bits(), repaints }
    }
}

/// Equal recipes in one file make equal looks.
#[derive(PartialEq, Eq, Hash)]
pub(super) struct LookRecipe {
    /// As bits.
    emission_scale: u64,
    /// The nodes that repaint.
    repaints: Vec<usize>,
}

/// The materials that nodes repaint, and whether they exist. By number and name of the node.
#[derive(Default)]
pub(super) struct Asked(BTreeMap<(usize, String, String), bool>);

impl Asked {
    /// Records that `look` was applied to `paints`.
    pub(super) fn hear<'a>(&mut self, look: &Look, paints: impl IntoIterator<Item = &'a Paint> + Clone) {
        for repaint in &look.repaints {
            for material in repaint.changes.keys() {
                let met = paints.clone().into_iter().any(|paint| paint.name == *material);
                *self.0.entry((repaint.node, repaint.name.clone(), material.clone())).or_default() |= met;
            }
        }
    }

    /// Notes the materials that do not exist.
    pub(super) fn note(&self, notes: &mut Notes) {
        for ((_, node, material), _) in self.0.iter().filter(|(_, met)| !**met) {
            notes.add(node, format!("its extras repaint the material `{material}`, which nothing there has"));
        }
    }
}
