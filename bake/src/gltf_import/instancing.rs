//! EXT_mesh_gpu_instancing: the placements of a node with several copies of its mesh.
//!
//! Accessors give TRANSLATION, ROTATION and SCALE of each copy, in the node's coordinates; missing attributes default
//! to the identity. The copies replace the node's own mesh; nodes below it are not copied.

use super::accessors::{check_type, components};
use super::document::{Document, label};
use super::nodes::PlacedNode;
use equilux_formats::Result;
use glam::{DAffine3, DQuat, DVec3};
use gltf::accessor::{DataType, Dimensions};
use serde_json::Value;

/// The name of the extension.
pub(super) const INSTANCING: &str = "EXT_mesh_gpu_instancing";

/// The largest number of copies in a scene: each exchanges light with all others, and an accessor without data could
/// state any count.
pub(super) const MOST_COPIES: usize = 1 << 14;

impl PlacedNode<'_> {
    /// Whether the extension places its contents.
    pub(super) fn is_instanced(&self) -> bool {
        self.node.extension_value(INSTANCING).is_some()
    }

    /// Names and placements of its contents: one with its own name, or those of the extension, `name #0` and so on.
    pub(super) fn copies(&self, document: &Document) -> Result<Vec<(String, DAffine3)>> {
        let once = || Ok(vec![(self.name(), self.placement)]);
        let Some(extension) = self.node.extension_value(INSTANCING) else { return once() };
        if has_only_own_attributes(extension) {
            return once();
        }
        let transforms = Attributes { document, node: label(&self.node), extension }.transforms()?;
        let place = |(number, copy): (usize, DAffine3)| {
            let placement = self.placement * copy;
            match placement.is_finite() {
                true => Ok((format!("{} #{number}", self.name()), placement)),
                false => Err(document.error(
                    format!(
                        "copy {number} of node {} with a transform too large to compute with",
                        self.name()
                    ),
                    "coordinates of a few kilometres at most",
                    "correct the scales of the node and of its copies",
                )),
            }
        };
        transforms.into_iter().enumerate().map(place).collect()
    }
}

/// Whether all attributes are application-specific: such copies coincide, and one is enough.
fn has_only_own_attributes(extension: &Value) -> bool {
    let attributes = extension.get("attributes").and_then(Value::as_object);
    attributes.is_some_and(|all| !all.is_empty() && all.keys().all(|name| name.starts_with('_')))
}

struct Attributes<'a> {
    document: &'a Document,
    node: String,
    extension: &'a Value,
}

impl Attributes<'_> {
    fn transforms(&self) -> Result<Vec<DAffine3>> {
        let (floats, turns) = (&[DataType::F32][..], &[DataType::F32, DataType::I16, DataType::I8][..]);
        let translations = self.values("TRANSLATION", Dimensions::Vec3, floats)?;
        let rotations = self.values("ROTATION", Dimensions::Vec4, turns)?;
        let scales = self.values("SCALE", Dimensions::Vec3, floats)?;
        let count = self.count([(&translations, 3), (&rotations, 4), (&scales, 3)])?;
        let vector = |values: &Option<Vec<f64>>, copy: usize, otherwise: DVec3| {
            values.as_ref().map_or(otherwise, |values| DVec3::from_slice(&values[3 * copy..]))
        };
        let transform =
            |copy: usize| {
                let rotation = match &rotations {
                    None => DQuat::IDENTITY,
                    Some(values) => self.rotation(copy, DQuat::from_slice(&values[4 * copy..]))?,
                };
                let (scale, translation) =
                    (vector(&scales, copy, DVec3::ONE), vector(&translations, copy, DVec3::ZERO));
                let transform = DAffine3::from_scale_rotation_translation(scale, rotation, translation);
                match transform.is_finite() {
                    true => Ok(transform),
                    false => Err(self
                        .error(format!("copy {copy} with a transform that is not finite"), "finite numbers")),
                }
            };
        (0..count).map(transform).collect()
    }

    fn rotation(&self, copy: usize, rotation: DQuat) -> Result<DQuat> {
        match rotation.length() > 0.0 && rotation.is_finite() {
            true => Ok(rotation.normalize()),
            false => {
                Err(self
                    .error(format!("copy {copy} with a rotation that is no quaternion"), "a unit quaternion"))
            }
        }
    }

    /// The number of copies, which must be the same for all attributes.
    fn count(&self, attributes: [(&Option<Vec<f64>>, usize); 3]) -> Result<usize> {
        let counts = attributes.map(|(values, width)| values.as_ref().map(|values| values.len() / width));
        let mut given = counts.into_iter().flatten();
        let Some(count) = given.next() else {
            return Err(self.error("no attribute", "TRANSLATION, ROTATION or SCALE"));
        };
        match given.find(|other| *other != count) {
            Some(other) => {
                Err(self.error(format!("attributes of {count} and of {other} copies"), "equal counts"))
            }
            None => Ok(count),
        }
    }

    /// All numbers of an attribute, if present.
    fn values(&self, name: &str, dimensions: Dimensions, types: &[DataType]) -> Result<Option<Vec<f64>>> {
        let Some(index) = self.extension.get("attributes").and_then(|attributes| attributes.get(name)) else {
            return Ok(None);
        };
        let number = index.as_u64().and_then(|index| usize::try_from(index).ok());
        let Some(accessor) = number.and_then(|number| self.document.gltf.accessors().nth(number)) else {
            let accessors = self.document.gltf.accessors().len();
            return Err(self.error(
                format!("{name} in accessor {index}"),
                format!("the number of one of the file's {accessors} accessors"),
            ));
        };
        let what = format!("{INSTANCING} of node {}: {name}", self.node);
        check_type(self.document, &accessor, &what, dimensions, types)?;
        if accessor.data_type() != DataType::F32 && !accessor.normalized() {
            return Err(
                self.error(format!("{name} in integers that are not normalised"), "normalised integers")
            );
        }
        if accessor.count() > MOST_COPIES {
            return Err(self.error(format!("{} copies", accessor.count()), format!("at most {MOST_COPIES}")));
        }
        components(self.document, &accessor, &what).map(Some)
    }

    fn error(&self, found: impl std::fmt::Display, expected: impl Into<String>) -> equilux_formats::Error {
        let found = format!("{INSTANCING} of node {} with {found}", self.node);
        self.document.error(found, expected, "export the file again, or place the copies as nodes")
    }
}
