//! Form factors from an instance to the sources of light near it.

use crate::rows::Rows;

/// Form factors from the unknowns of an instance to sources near it. Sources are named by what they look like and where they are,
/// so that the same block serves a scene in which others came or went.
#[derive(Debug, Clone, PartialEq)]
pub struct SourceRows {
    /// The identities of the sources, rising.
    pub sources: Vec<u64>,
    /// For each run of neighbouring unknowns the sources whose light they get by these form factors, by place among `sources`,
    /// rising.
    pub runs: Vec<Vec<u32>>,
    /// `unknowns × sources`.
    pub rows: Rows,
}
