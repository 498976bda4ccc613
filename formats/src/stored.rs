//! Storage of results in containers: plain arrays, validated when they are read.
//!
//! The checksums already detect damage. These checks establish the invariants of the types, so that computations can
//! rely on them.

mod geometry;
mod light;
mod rows;
mod solution;
mod source_rows;

use crate::container::{Kind, Number, Reader, Writer};
use crate::error::Result;
use crate::fingerprint::Manifest;
use crate::rgb::Rgb;

/// A type stored in a file of its own.
pub trait Stored: Sized + Send + 'static {
    /// The kind of its file.
    const KIND: Kind;

    /// The file for `self`, with the inputs in `manifest`.
    fn write(&self, manifest: &Manifest) -> Writer;

    /// Reads a value, bit-identical to the written one.
    fn read(reader: &mut Reader) -> Result<Self>;
}

/// Fails with `problem` unless `fine`.
fn check(reader: &Reader, fine: bool, problem: impl FnOnce() -> String) -> Result<()> {
    if fine { Ok(()) } else { Err(reader.damaged(problem())) }
}

/// An array that must hold `count` numbers.
fn array_of<T: Number>(reader: &mut Reader, name: &str, count: usize) -> Result<Vec<T>> {
    let values = reader.array(name)?;
    check(reader, values.len() == count, || format!("{} {name} instead of {count}", values.len()))?;
    Ok(values)
}

/// An array of finite numbers.
fn finite_array<T: Number + Into<f64>>(reader: &mut Reader, name: &str) -> Result<Vec<T>> {
    let values = reader.array::<T>(name)?;
    let is_finite = |&value: &T| Into::<f64>::into(value).is_finite();
    check(reader, values.iter().all(is_finite), || format!("{name} that are not finite"))?;
    Ok(values)
}

/// Rows of `N` finite numbers.
fn finite_rows<const N: usize>(reader: &mut Reader, name: &str) -> Result<Vec<[f64; N]>> {
    let values: Vec<f64> = finite_array(reader, name)?;
    let (rows, rest) = values.as_chunks::<N>();
    check(reader, rest.is_empty(), || format!("{} {name}, not a multiple of {N}", values.len()))?;
    Ok(rows.to_vec())
}

/// An array of finite RGB values.
fn finite_lights(reader: &mut Reader, name: &str) -> Result<Vec<Rgb>> {
    Ok(finite_rows(reader, name)?.into_iter().map(Rgb).collect())
}
