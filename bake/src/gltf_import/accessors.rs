//! Reads accessors: their components as f64, for any type, stride, normalisation or sparseness. The gltf crate's
//! readers are not used because they panic on quantised positions and on truncated sparse data. glTF 2.0 specification,
//! §3.6.2.

use super::document::Document;
use equilux_formats::{Error, Result};
use gltf::accessor::sparse::IndexType;
use gltf::accessor::{DataType, Dimensions};
use gltf::buffer::View;
use gltf::json::validation::Checked;

/// The largest number of elements of an accessor: one without a buffer view could state any count.
const MOST_ELEMENTS: usize = 1 << 26;

/// The components of `accessor`, element after element. Errors call them `what`.
pub(super) fn components(document: &Document, accessor: &gltf::Accessor, what: &str) -> Result<Vec<f64>> {
    let reader = AccessorReader { document, what, accessor };
    reader.check_count()?;
    let layout = Layout {
        component: accessor.data_type(),
        width: accessor.dimensions().multiplicity(),
        normalised: accessor.normalized(),
    };
    let mut values = match accessor.view() {
        Some(view) => reader.values(&view, accessor.offset(), accessor.count(), layout)?,
        None => vec![0.0; accessor.count() * layout.width],
    };
    if let Some(sparse) = accessor.sparse() {
        reader.overwrite(&mut values, &sparse, layout)?;
    }
    Ok(values)
}

/// Whether `accessor` holds elements of `dimensions` with components of one of `types`.
pub(super) fn check_type(
    document: &Document,
    accessor: &gltf::Accessor,
    what: &str,
    dimensions: Dimensions,
    types: &[DataType],
) -> Result<()> {
    // From the JSON, because the crate panics on unknown types.
    let json = &document.gltf.as_json().accessors[accessor.index()];
    let (component, kind) = (known(&json.component_type), known(&json.type_));
    if kind == Some(dimensions) && component.is_some_and(|component| types.contains(&component.0)) {
        return Ok(());
    }
    let name = |known: Option<String>| known.unwrap_or_else(|| "an unknown type".to_owned());
    Err(document.error(
        format!(
            "{what} in accessor {} as {} of {}",
            accessor.index(),
            name(kind.map(|kind| format!("{kind:?}"))),
            name(component.map(|component| format!("{:?}", component.0))),
        ),
        format!("{dimensions:?} of {types:?}"),
        "export the file again",
    ))
}

fn known<T: Copy>(checked: &Checked<T>) -> Option<T> {
    match checked {
        Checked::Valid(value) => Some(*value),
        Checked::Invalid => None,
    }
}

/// How an element lies in memory.
#[derive(Clone, Copy)]
struct Layout {
    component: DataType,
    width: usize,
    normalised: bool,
}

impl Layout {
    fn size(self) -> usize {
        self.component.size() * self.width
    }

    fn components(self, element: &[u8]) -> impl Iterator<Item = f64> {
        element.chunks_exact(self.component.size()).map(move |bytes| self.component(bytes))
    }

    fn component(self, bytes: &[u8]) -> f64 {
        let fraction = |value: f64, one: f64| if self.normalised { (value / one).max(-1.0) } else { value };
        match self.component {
            DataType::I8 => fraction(f64::from(i8::from_le_bytes(exactly(bytes))), 127.0),
            DataType::U8 => fraction(f64::from(bytes[0]), 255.0),
            DataType::I16 => fraction(f64::from(i16::from_le_bytes(exactly(bytes))), 32767.0),
            DataType::U16 => fraction(f64::from(u16::from_le_bytes(exactly(bytes))), 65535.0),
            DataType::U32 => f64::from(u32::from_le_bytes(exactly(bytes))),
            DataType::F32 => f64::from(f32::from_le_bytes(exactly(bytes))),
        }
    }
}

fn index_component(index: IndexType) -> DataType {
    match index {
        IndexType::U8 => DataType::U8,
        IndexType::U16 => DataType::U16,
        IndexType::U32 => DataType::U32,
    }
}

fn exactly<const N: usize>(bytes: &[u8]) -> [u8; N] {
    bytes.try_into().expect("a chunk has the size of its component")
}

struct AccessorReader<'a> {
    document: &'a Document,
    what: &'a str,
    accessor: &'a gltf::Accessor<'a>,
}

impl AccessorReader<'_> {
    fn error(&self, found: impl std::fmt::Display, expected: impl Into<String>) -> Error {
        let found = format!("{} in accessor {}: {found}", self.what, self.accessor.index());
        self.document.error(found, expected, "export the file again, it contradicts itself or is truncated")
    }

    fn check_count(&self) -> Result<()> {
        match self.accessor.count() {
            0..=MOST_ELEMENTS => Ok(()),
            count => {
                Err(self.error(format!("{count} elements"), format!("at most {MOST_ELEMENTS} elements")))
            }
        }
    }

    fn values(&self, view: &View, offset: usize, count: usize, layout: Layout) -> Result<Vec<f64>> {
        let (bytes, stride) = self.bytes(view, offset, count, layout.size())?;
        let elements = bytes.chunks(stride).map(|chunk| &chunk[..layout.size()]);
        Ok(elements.flat_map(|element| layout.components(element)).collect())
    }

    /// The bytes of `count` elements of `size` bytes each, and the stride between them.
    fn bytes(&self, view: &View, offset: usize, count: usize, size: usize) -> Result<(&[u8], usize)> {
        let stride = view.stride().unwrap_or(size);
        if stride < size {
            return Err(self.error(format!("a stride of {stride} bytes"), format!("at least {size} bytes")));
        }
        let length = match count {
            0 => Some(0),
            _ => stride.checked_mul(count - 1).and_then(|length| length.checked_add(size)),
        };
        let end = length.and_then(|length| length.checked_add(offset));
        let held = self
            .document
            .buffers
            .view(view, &format!("{} in accessor {}", self.what, self.accessor.index()))?;
        end.and_then(|end| held.get(offset..end)).map(|bytes| (bytes, stride)).ok_or_else(|| {
            self.error(
                format!(
                    "{count} elements reach past the {} bytes of buffer view {}",
                    held.len(),
                    view.index()
                ),
                "elements within the view",
            )
        })
    }

    fn overwrite(
        &self,
        values: &mut [f64],
        sparse: &gltf::accessor::sparse::Sparse,
        layout: Layout,
    ) -> Result<()> {
        let (places, news) = (sparse.indices(), sparse.values());
        let place_layout =
            Layout { component: index_component(places.index_type()), width: 1, normalised: false };
        let at = self.values(&places.view(), places.offset(), sparse.count(), place_layout)?;
        let new = self.values(&news.view(), news.offset(), sparse.count(), layout)?;
        for (at, new) in at.iter().map(|&at| at as usize).zip(new.chunks_exact(layout.width)) {
            let count = values.len() / layout.width;
            let Some(value) = values.chunks_exact_mut(layout.width).nth(at) else {
                return Err(self.error(format!("sparse index {at}"), format!("an index below {count}")));
            };
            value.copy_from_slice(new);
        }
        Ok(())
    }
}
