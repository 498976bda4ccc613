//! Manifests list the inputs of a result. Both the cache key of the result and the reason why it is computed again
//! derive from the manifest, so the two are always consistent.
//!
//! A manifest consists of labelled values and digests of content, never times or file names.

use serde::{Deserialize, Serialize};
use std::fmt;

/// The blake3 hash of some content.
#[derive(Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
pub struct Digest([u8; 32]);

/// The hash of a manifest: the cache key of its result.
#[derive(Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
pub struct Key(Digest);

impl Digest {
    /// The digest with this hexadecimal form.
    pub(crate) fn from_hex(text: &str) -> Option<Self> {
        blake3::Hash::from_hex(text).ok().map(|hash| Self(*hash.as_bytes()))
    }

    /// The first 64 bits of it as a number.
    pub fn first_bytes(&self) -> u64 {
        u64::from_le_bytes(self.0[..8].try_into().expect("eight bytes"))
    }
}

impl fmt::Display for Digest {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str(&blake3::Hash::from_bytes(self.0).to_hex())
    }
}

impl fmt::Debug for Digest {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        fmt::Display::fmt(self, f)
    }
}

impl fmt::Display for Key {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        fmt::Display::fmt(&self.0, f)
    }
}

impl fmt::Debug for Key {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        fmt::Display::fmt(&self.0, f)
    }
}

impl std::str::FromStr for Key {
    type Err = ();

    /// Parses the displayed form.
    fn from_str(text: &str) -> Result<Self, ()> {
        Digest::from_hex(text).map(Self).ok_or(())
    }
}

impl From<Key> for Digest {
    fn from(key: Key) -> Self {
        key.0
    }
}

/// Content to be hashed. Each piece is hashed with its length, so that `ab, c` and `a, bc` differ.
#[derive(Debug, Clone, Default)]
pub struct Content(blake3::Hasher);

impl Content {
    /// Empty content.
    pub fn new() -> Self {
        Self::default()
    }

    /// Adds bytes: a text, or integers through `bytemuck::cast_slice`.
    pub fn bytes(mut self, bytes: impl AsRef<[u8]>) -> Self {
        let bytes = bytes.as_ref();
        self.0.update(&(bytes.len() as u64).to_le_bytes());
        self.0.update(bytes);
        self
    }

    /// Adds numbers. −0 counts as 0, because the two are equal.
    pub fn f64s(self, values: &[f64]) -> Self {
        let unsigned_zeros: Vec<f64> = values.iter().map(|value| value + 0.0).collect();
        self.bytes(bytemuck::cast_slice::<f64, u8>(&unsigned_zeros))
    }

    /// The digest of everything added, in order.
    pub fn digest(&self) -> Digest {
        Digest(*self.0.finalize().as_bytes())
    }
}

/// The inputs of a result, as an ordered list of labelled entries.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
pub struct Manifest {
    entries: Vec<Entry>,
}

#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
struct Entry {
    label: String,
    value: Value,
}

/// Settings are short enough for messages, details are not; larger content is a digest. A remark explains a digest in a
/// few words and is not part of the key.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
enum Value {
    Setting(String),
    Detail(String),
    Digest(Digest),
    Remark(String),
}

impl Manifest {
    /// A manifest without entries.
    pub fn new() -> Self {
        Self::default()
    }

    /// Adds a setting, with its unit: `("element size", "0.25 m")`. Panics when the label is taken.
    pub fn setting(self, label: impl Into<String>, value: impl fmt::Display) -> Self {
        self.with(label.into(), Value::Setting(value.to_string()))
    }

    /// Adds a setting that is too long for messages, but available from [`Manifest::details`]. Panics when the label is taken.
    pub fn detail(self, label: impl Into<String>, value: impl fmt::Display) -> Self {
        self.with(label.into(), Value::Detail(value.to_string()))
    }

    /// Adds words that explain a digest, such as the element size of a geometry. Reasons mention them like settings, but the
    /// key does not depend on them: equal content has equal keys. Panics when the label is taken.
    pub fn remark(self, label: impl Into<String>, value: impl fmt::Display) -> Self {
        self.with(label.into(), Value::Remark(value.to_string()))
    }

    /// The details, with their labels, in order.
    pub fn details(&self) -> impl Iterator<Item = (&str, &str)> {
        self.entries.iter().filter_map(|entry| match &entry.value {
            Value::Detail(text) => Some((entry.label.as_str(), text.as_str())),
            _ => None,
        })
    }

    /// Whether the two differ in details only, or not at all.
    pub fn is_alike(&self, other: &Self) -> bool {
        let rest = |manifest: &Self| -> Vec<Entry> {
            let entries = manifest.entries.iter().filter(|entry| !matches!(entry.value, Value::Detail(_)));
            entries.cloned().collect()
        };
        rest(self) == rest(other)
    }

    /// Whether it begins with all entries of another.
    pub fn extends(&self, other: &Self) -> bool {
        self.entries.starts_with(&other.entries)
    }

    /// Adds content by its digest, or another result by its key. Panics when the label is taken.
    pub fn digest(self, label: impl Into<String>, digest: impl Into<Digest>) -> Self {
        self.with(label.into(), Value::Digest(digest.into()))
    }

    fn with(mut self, label: String, value: Value) -> Self {
        assert!(self.value(&label).is_none(), "the manifest already has an entry {label:?}");
        self.entries.push(Entry { label, value });
        self
    }

    fn value(&self, label: &str) -> Option<&Value> {
        self.entries.iter().find(|entry| entry.label == label).map(|entry| &entry.value)
    }

    /// The key of the result of exactly these inputs.
    pub fn key(&self) -> Key {
        let content = self.entries.iter().fold(Content::new(), |content, entry| {
            let labelled = |content: Content| content.bytes(&entry.label);
            match &entry.value {
                Value::Setting(text) => labelled(content).bytes("setting").bytes(text),
                Value::Detail(text) => labelled(content).bytes("detail").bytes(text),
                Value::Digest(digest) => labelled(content).bytes("digest").bytes(digest.0),
                Value::Remark(_) => content,
            }
        });
        Key(content.digest())
    }

    /// Why the result of `old` cannot be reused: one clause for each entry that differs, or none if the keys are equal.
    pub fn difference(&self, old: &Manifest) -> Option<String> {
        if self.key() == old.key() {
            return None;
        }
        let differing = self.entries.iter().filter_map(|entry| entry.clause(old.value(&entry.label)));
        let gone = old.entries.iter().filter(|entry| self.value(&entry.label).is_none());
        let clauses: Vec<_> = differing.chain(gone.map(|entry| format!("{} is gone", entry.label))).collect();
        // The key also depends on the order, and every new key needs a reason.
        Some(if clauses.is_empty() { "the order of the inputs changed".into() } else { clauses.join("; ") })
    }
}

impl Entry {
    /// How this entry differs from its `old` value, if it does.
    fn clause(&self, old: Option<&Value>) -> Option<String> {
        let label = &self.label;
        match (old, &self.value) {
            (Some(old), new) if old == new => None,
            (Some(Value::Setting(old) | Value::Remark(old)), Value::Setting(new) | Value::Remark(new)) => {
                (old != new).then(|| format!("{label} was {old}, is {new}"))
            }
            (Some(_), _) => Some(format!("{label} changed")),
            (None, Value::Setting(new) | Value::Remark(new)) => Some(format!("{label} is new, {new}")),
            (None, Value::Detail(_) | Value::Digest(_)) => Some(format!("{label} is new")),
        }
    }
}
