//! Changes of the materials below a node by its extras: `emission_scale`, and `materials` by name. Turns paints as files
//! have them into paints as they look there, and notes names that no material has.

use super::materials::Paint;
use super::notes::Notes;
use serde::Deserialize;
use serde_json::Value;
use std::collections::BTreeMap;
use std::rc::Rc;

/// Changes by the name of the material.
pub(super) type Changes = BTreeMap<String, Change>;

/// What becomes of a material; what is not told stays.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(rename_all = "camelCase", deny_unknown_fields)]
pub(super) struct Change {
    base_color_factor: Option<[f64; 4]>,
    emissive_factor: Option<[f64; 3]>,
    emissive_strength: Option<f64>,
}

/// The changes that `value` in the extras tells, if they make sense.
pub(super) fn changes(value: &Value) -> Option<Changes> {
    let changes: Changes = serde_json::from_value(value.clone()).ok()?;
    changes.values().all(Change::is_possible).then_some(changes)
}

impl Change {
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

/// The changes that one node asks for.
#[derive(Debug)]
pub(super) struct Repaint {
    /// The node's number in its file.
    node: usize,
    /// What the node is called.
    name: String,
    changes: Changes,
}

impl Repaint {
    /// The changes that `node`, which is called `name`, asks for.
    pub(super) fn new(node: &gltf::Node, name: String, changes: &Changes) -> Self {
        Self { node: node.index(), name, changes: changes.clone() }
    }
}

/// What nodes change about the materials of what hangs below them.
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

    /// What tells this look from others in one file.
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

/// Which materials nodes ask to repaint, and whether there were any. By number and name of the node.
#[derive(Default)]
pub(super) struct Asked(BTreeMap<(usize, String, String), bool>);

impl Asked {
    /// Takes up that `look` was to change `paints`.
    pub(super) fn hear<'a>(&mut self, look: &Look, paints: impl IntoIterator<Item = &'a Paint> + Clone) {
        for repaint in &look.repaints {
            for material in repaint.changes.keys() {
                let met = paints.clone().into_iter().any(|paint| paint.name == *material);
                *self.0.entry((repaint.node, repaint.name.clone(), material.clone())).or_default() |= met;
            }
        }
    }

    /// Notes the materials that were not there.
    pub(super) fn note(&self, notes: &mut Notes) {
        for ((_, node, material), _) in self.0.iter().filter(|(_, met)| !**met) {
            notes.add(node, format!("its extras repaint the material `{material}`, which nothing there has"));
        }
    }
}
