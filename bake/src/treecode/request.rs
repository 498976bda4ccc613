//! What a block is computed of: a world, receivers, senders, and how exactly.

use super::resolution::Resolution;
use super::revision::Revision;
use crate::world::World;
use equilux_formats::Element;
use std::ops::Range;

/// The receivers of a block.
#[derive(Debug, Clone, Copy)]
pub enum Audience<'a> {
    /// The elements of an instance of the world.
    Instance(usize),
    /// Other points, at the centroids of these elements, each of which lies in a face of the world. The nearer two are in
    /// this order the more of their search they share.
    Points(&'a [Element]),
}

impl<'a> Audience<'a> {
    /// The receivers' elements.
    pub(crate) fn elements(self, world: &'a World) -> &'a [Element] {
        match self {
            Self::Instance(instance) => &world.elements[world.elements_of(instance)],
            Self::Points(elements) => elements,
        }
    }
}

/// One block to be computed.
pub struct Request<'a> {
    /// The geometry.
    pub world: &'a World,
    /// The receivers.
    pub receivers: Audience<'a>,
    /// The instances that send.
    pub senders: &'a [usize],
    /// The range of nodes that columns count through.
    pub columns: Range<usize>,
    /// What each receiver is known to see already (of other senders), if anything.
    pub already: Option<&'a [f64]>,
    /// How exactly.
    pub resolution: Resolution,
    /// The block as it was before the scene changed, if it is only to be brought up to date.
    pub revision: Option<Revision<'a>>,
}
