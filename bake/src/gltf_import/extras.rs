//! Settings in a node's `extras`: `part`, `element_size`, `emission_scale`, `materials`, `angular_diameter`,
//! `local_solver`, `texel_size`, `lightmap`, `bake`. Other keys are ignored.

use super::document::{Document, label};
use super::repaint::{Changes, changes};
use equilux_formats::{LocalSolver, Result, TexelChoice};
use serde_json::Value;

/// The known keys.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct Extras {
    /// Path of a part file that replaces the contents of this node, relative to the node's file.
    pub(super) part: Option<String>,
    /// Size of the part's elements, metres.
    pub(super) element_size: Option<f64>,
    /// Factor on the emission of everything below the node.
    pub(super) emission_scale: Option<f64>,
    /// Changes of the materials of everything below the node.
    pub(super) materials: Option<Changes>,
    /// Angular diameter of the directional light at the node, degrees.
    pub(super) angular_diameter: Option<f64>,
    /// The solver of the part's local equilibrium.
    pub(super) local_solver: Option<LocalSolver>,
    /// The texels of everything below the node.
    pub(super) texels: TexelChoice,
    /// Whether the node and everything below it take part at all.
    pub(super) bake: Option<bool>,
}

impl Extras {
    /// Parses the extras of `node`. Errors name node, key and value.
    pub(super) fn of(document: &Document, node: &gltf::Node) -> Result<Self> {
        let values = node.extras().as_ref().and_then(|raw| serde_json::from_str(raw.get()).ok());
        let Some(Value::Object(values)) = values else { return Ok(Self::default()) };
        let key = Keys { document, node, values: &values };
        Ok(Self {
            part: key.get("part", "the path of a glTF file", path)?,
            element_size: key.get("element_size", LENGTH, length)?,
            emission_scale: key.get("emission_scale", "a number, 0 or more", |value| {
                value.as_f64().filter(|&scale| scale.is_finite() && scale >= 0.0)
            })?,
            materials: key.get(
                "materials",
                "materials' names, each with any of baseColorFactor (4 numbers, 0 to 1), emissiveFactor (3 numbers) and \
                 emissiveStrength (a number), 0 or more",
                changes,
            )?,
            angular_diameter: key.get("angular_diameter", "a number from 0 to 90, degrees", |value| {
                value.as_f64().filter(|angle| (0.0..=90.0).contains(angle))
            })?,
            local_solver: key.get(
                "local_solver",
                "\"direct\", \"gauss-seidel\", \"progressive\" or \"iterative\"",
                |value| serde_json::from_value(value.clone()).ok(),
            )?,
            texels: TexelChoice {
                size: key.get("texel_size", LENGTH, length)?,
                any: key.get("lightmap", "true or false", Value::as_bool)?,
            },
            bake: key.get("bake", "true or false", Value::as_bool)?,
        })
    }

    /// Whether any of the keys is there that says more about the node than the nodes below it inherit.
    pub(super) fn any(&self) -> bool {
        *self != Self { texels: self.texels, bake: self.bake, ..Self::default() }
    }

    /// Whether the node and everything below it are ignored.
    pub(super) fn ignored(&self) -> bool {
        self.bake == Some(false)
    }
}

const LENGTH: &str = "a number above 0, metres";

fn length(value: &Value) -> Option<f64> {
    value.as_f64().filter(|&size| size.is_finite() && size > 0.0)
}

fn path(value: &Value) -> Option<String> {
    value.as_str().filter(|path| !path.is_empty()).map(str::to_owned)
}

struct Keys<'a> {
    document: &'a Document,
    node: &'a gltf::Node<'a>,
    values: &'a serde_json::Map<String, Value>,
}

impl Keys<'_> {
    fn get<T>(&self, key: &str, expected: &str, read: impl Fn(&Value) -> Option<T>) -> Result<Option<T>> {
        let Some(value) = self.values.get(key) else { return Ok(None) };
        read(value).map(Some).ok_or_else(|| {
            self.document.error(
                format!("node {} with {key} = {value} in its extras", label(self.node)),
                expected,
                format!("correct the custom property {key}"),
            )
        })
    }
}
