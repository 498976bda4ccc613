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

/// One block to compute.
pub struct Request<'a> {
    /// The geometry.
    pub world: &'a World,
    /// The receivers of a block.
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

impl<'a> Request<'a> {
    /// The whole block from these receivers to the elements of these instances; columns count through all nodes of the world.
    pub fn new(
        world: &'a World,
        receivers: Audience<'a>,
        senders: &'a [usize],
        resolution: Resolution,
    ) -> Self {
        let columns = 0..world.nodes.len();
        Self { world, receivers, senders, columns, already: None, resolution, revision: None }
    }

    /// The self block of an instance, whose columns count through its own nodes: `senders` is that instance.
    pub fn of_self(world: &'a World, senders: &'a [usize; 1], resolution: Resolution) -> Self {
        let [instance] = *senders;
        Self::new(world, Audience::Instance(instance), senders, resolution)
            .with_columns(world.nodes_of(instance))
    }

    /// Columns count through these nodes.
    pub fn with_columns(self, columns: Range<usize>) -> Self {
        Self { columns, ..self }
    }

    /// Each receiver is known to see this share of its hemisphere already, of other senders.
    pub fn with_already(self, already: Option<&'a [f64]>) -> Self {
        Self { already, ..self }
    }

    /// The block is an older one, brought up to date, if there is one.
    pub fn with_revision(self, revision: Option<Revision<'a>>) -> Self {
        Self { revision, ..self }
    }
}
