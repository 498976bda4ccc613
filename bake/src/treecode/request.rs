//! The specification of a block: world, receivers, senders and resolution.

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
    /// Other points, at the centroids of these elements, each of which lies in a face of the world. Points that are
    /// close in this order share more of their search.
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
#[derive(Debug)]
pub struct Request<'a> {
    /// The geometry.
    pub world: &'a World,
    /// The receivers of a block.
    pub receivers: Audience<'a>,
    /// The instances that send.
    pub senders: &'a [usize],
    /// The nodes that the columns stand for.
    pub columns: Range<usize>,
    /// The share of its hemisphere that each receiver is known to see of other senders, if known.
    pub already: Option<&'a [f64]>,
    /// The resolution.
    pub resolution: Resolution,
    /// The block before the scene changed, if it is updated instead of computed from scratch.
    pub revision: Option<Revision<'a>>,
}

impl<'a> Request<'a> {
    /// The whole block from these receivers to the elements of these instances, with a column for each node of the world.
    pub fn new(
        world: &'a World,
        receivers: Audience<'a>,
        senders: &'a [usize],
        resolution: Resolution,
    ) -> Self {
        let columns = 0..world.nodes.len();
        Self { world, receivers, senders, columns, already: None, resolution, revision: None }
    }

    /// The self block of an instance, with a column for each of its nodes. `senders` is that instance.
    pub fn of_self(world: &'a World, senders: &'a [usize; 1], resolution: Resolution) -> Self {
        let [instance] = *senders;
        Self::new(world, Audience::Instance(instance), senders, resolution)
            .with_columns(world.nodes_of(instance))
    }

    /// With a column for each of these nodes.
    pub fn with_columns(self, columns: Range<usize>) -> Self {
        Self { columns, ..self }
    }

    /// With the share of its hemisphere that each receiver is known to see of other senders.
    pub fn with_already(self, already: Option<&'a [f64]>) -> Self {
        Self { already, ..self }
    }

    /// With the older block to update, if there is one.
    pub fn with_revision(self, revision: Option<Revision<'a>>) -> Self {
        Self { revision, ..self }
    }
}
