//! The senders that a group of receivers may see, each with a list of possible occluders; narrowed as receivers are halved.

use super::candidates::{Candidates, Entry, Verdict};
use super::request::Request;
use super::viewers::Viewers;
use crate::world::Sender;
use std::ops::Range;

/// Senders that a group of receivers may see, and their possible occluders.
pub struct Frontier<'a> {
    candidates: Candidates<'a>,
    senders: Vec<(u32, Range<usize>)>,
}

/// A frontier does not open senders smaller than this share of the receivers' size, or of the distance to them.
const MAX_CLOSED_RATIO: f64 = 0.5;

impl<'a> Frontier<'a> {
    /// All senders, each with all occluders.
    pub fn all(request: &Request<'a>) -> Self {
        let (candidates, all) = Candidates::all(request.world);
        let roots = request.senders.iter().filter_map(|&sender| request.world.root_of(sender));
        Self { candidates, senders: roots.map(|root| (root as u32, all.clone())).collect() }
    }

    /// Whether there are no senders.
    pub fn is_empty(&self) -> bool {
        self.senders.is_empty()
    }

    /// The senders and their lists.
    pub fn senders(&self) -> impl Iterator<Item = (u32, &[Entry])> {
        self.senders.iter().map(|(node, list)| (*node, self.candidates.slice(list.clone())))
    }

    /// The frontier of some of the receivers.
    pub fn narrowed(&self, request: &Request<'a>, viewers: &Viewers) -> Self {
        let mut candidates = Candidates::none(request.world);
        let mut narrowed = Self { candidates: Candidates::none(request.world), senders: vec![] };
        let mut open: Vec<(u32, Range<usize>)> = Vec::new();
        for (node, list) in self.senders() {
            open.push((node, candidates.adopt(list)));
            while let Some((node, list)) = open.pop() {
                let sender = &request.world.nodes[node as usize];
                if viewers.cannot_see(sender, request.world) || is_untouched(request, viewers, node) {
                    continue;
                }
                let Verdict::Between(kept) = candidates.narrow(list, viewers, sender) else { continue };
                match sender.children {
                    Some(children) if !stays_closed(sender, viewers) => {
                        open.extend(children.into_iter().rev().map(|child| (child, kept.clone())));
                    }
                    _ => {
                        let list = narrowed.candidates.adopt(candidates.slice(kept));
                        narrowed.senders.push((node, list));
                    }
                }
            }
        }
        narrowed
    }
}

/// Whether a change cannot affect a sender that is not flat, and that therefore had no entry. Flat senders are tested
/// entry by entry later.
fn is_untouched(request: &Request, viewers: &Viewers, node: u32) -> bool {
    let (world, Some(revision)) = (request.world, &request.revision) else { return false };
    let sender = &world.nodes[node as usize];
    let is_outermost =
        |node| world.parent_of(node).is_none_or(|p| world.nodes[p as usize].polygon.is_empty());
    (sender.polygon.is_empty() || is_outermost(node))
        && !revision.change.anew[world.instance_of_node(node as usize)]
        && !revision.change.touches(world, viewers, sender)
}

fn stays_closed(sender: &Sender, viewers: &Viewers) -> bool {
    let size = sender.bounds.diagonal();
    size <= MAX_CLOSED_RATIO * viewers.diameter.max(viewers.distance_to(sender))
}
