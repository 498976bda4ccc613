//! A tree of boxes, eight a node: which leaves a ray may pass through, nearer ones first. In f32, and rather too many than too few.

use super::lanes::{LANES, Lanes, Mask, max, min};
use crate::geometry::aabb::Aabb;
use crate::geometry::box_tree::{BoxTree, Inside};
use glam::{DVec3, Vec3};

/// Rounding of places in f32, relative to the extent of the tree: a few operations.
const ROUNDING: f32 = 8.0 * f32::EPSILON;

/// Rays that start farther away than this many extents start at the ball around the tree instead.
const FAR: f64 = 2.0;

/// Boxes that wait during a descent, with the distance at which the ray enters them; the nearest last.
struct Waiting {
    boxes: [(Child, f32); MOST_WAITING],
    count: usize,
}

/// The most levels of nodes in a tree: enough for 8¹³ leaves, and few enough for a ray's memory.
const LEVELS: u32 = 13;

/// A node takes one box off and adds up to eight.
const MOST_WAITING: usize = 1 + LEVELS as usize * (LANES - 1);

/// A ray: the points origin + t × direction with t > 0.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ray {
    /// Where it starts.
    pub origin: DVec3,
    /// Where it goes; t counts in units of it.
    pub direction: DVec3,
}

impl Ray {
    /// The point at t.
    #[inline(always)]
    pub fn at(&self, t: f64) -> DVec3 {
        self.origin + self.direction * t
    }
}

/// A ray in f32, relative to the centre of a tree.
#[derive(Debug, Clone, Copy)]
pub struct Ray32 {
    /// Origin.
    pub origin: Vec3,
    /// Direction, about of unit length.
    pub direction: Vec3,
    /// How far places computed in f32 may be off.
    pub rounding: f32,
}

/// What is done at the leaves that a ray passes through. Not a closure, since that cannot be forced inline, and only what
/// is inlined is compiled for the vectors of the machine.
pub trait Visitor {
    /// At this leaf, with the ray in f32, how far to look in f32, and how far in t. Returns how far in t to look on.
    fn leaf(&mut self, leaf: usize, ray: &Ray32, limit: f32, most: f64) -> f64;
}

/// Boxes around numbered items.
#[derive(Debug)]
pub struct WideTree {
    nodes: Vec<Node>,
    /// The items of each leaf.
    leaves: Vec<Vec<u32>>,
    /// The box around all items.
    pub bounds: Aabb,
    /// Its centre, which everything in f32 is relative to.
    pub centre: DVec3,
    /// The radius of the ball around the centre that holds all items.
    reach: f64,
}

/// Eight boxes, and what is in them.
#[derive(Debug, Clone)]
struct Node {
    /// Lowest and highest coordinates by axis.
    sides: [[Lanes; 3]; 2],
    children: [Child; LANES],
}

/// What a box holds: a node or a leaf, by number.
#[derive(Debug, Clone, Copy)]
struct Child(u32);

impl Child {
    const LEAF: u32 = 1 << 31;
    const NOTHING: Self = Self(u32::MAX);
}

impl WideTree {
    /// The tree over items with these boxes, with up to `most` in a leaf.
    pub fn new(boxes: &[Aabb], most: usize) -> Self {
        let bounds = boxes.iter().copied().fold(Aabb::EMPTY, Aabb::union);
        let (centre, reach) =
            if bounds.is_empty() { (DVec3::ZERO, 0.0) } else { (bounds.centre(), bounds.diagonal() / 2.0) };
        let mut tree = Self { nodes: vec![], leaves: vec![], bounds, centre, reach };
        let binary = BoxTree::new(boxes);
        if let Some(root) = binary.root() {
            let builder = Builder { binary: &binary, boxes, most };
            builder.node(&mut tree, builder.branch(root), LEVELS);
        }
        tree
    }

    /// The items of each leaf.
    pub fn leaves(&self) -> &[Vec<u32>] {
        &self.leaves
    }

    /// The leaves whose boxes meet `around`; none if there are more than `most`.
    pub fn meeting(&self, around: &Aabb, most: usize) -> Option<Vec<usize>> {
        // Rounding keeps the order of numbers, and boxes are rounded too.
        let [low, high] = [around.low, around.high].map(|corner| (corner - self.centre).as_vec3());
        let (mut found, mut open) = (vec![], vec![]);
        open.extend((!self.nodes.is_empty()).then_some(0));
        while let Some(number) = open.pop() {
            let Node { sides: [lows, highs], children } = &self.nodes[number as usize];
            let mut is_met = [true; LANES];
            for axis in 0..3 {
                for (k, is_met) in is_met.iter_mut().enumerate() {
                    *is_met &= (lows[axis].0[k] <= high[axis]) & (highs[axis].0[k] >= low[axis]);
                }
            }
            for child in Mask::of(is_met).map(|k| children[k].0) {
                if child & Child::LEAF == 0 {
                    open.push(child);
                } else {
                    found.push((child & !Child::LEAF) as usize);
                }
            }
            if found.len() + open.len() > most {
                return None;
            }
        }
        Some(found)
    }

    /// Visits the leaves whose boxes the ray meets with t up to `most`, roughly in order.
    #[inline(always)]
    pub fn along(&self, ray: &Ray, most: f64, visitor: &mut impl Visitor) {
        if self.nodes.is_empty() {
            return;
        }
        let length = ray.direction.length();
        let away = (ray.origin - self.centre).length() - self.reach;
        // From far away only the last stretch is of interest, and f32 has the digits for it.
        let skipped = if away > FAR * self.reach { away * (1.0 - 1e-6) / length } else { 0.0 };
        let ray32 = Ray32 {
            origin: (ray.at(skipped) - self.centre).as_vec3(),
            direction: (ray.direction / length).as_vec3(),
            rounding: ROUNDING * (4.0 * self.reach) as f32,
        };
        let (mut most, mut limit) = (most, in_f32(most - skipped, length));
        let slabs = Slabs::new(&ray32);
        let mut waiting = Waiting { boxes: [(Child(0), 0.0); MOST_WAITING], count: 1 };
        while waiting.count > 0 {
            waiting.count -= 1;
            let (child, entered) = waiting.boxes[waiting.count];
            if entered > limit {
                continue;
            }
            if child.0 & Child::LEAF == 0 {
                self.nodes[child.0 as usize].open(&slabs, limit, &mut waiting);
            } else {
                let further = visitor.leaf((child.0 & !Child::LEAF) as usize, &ray32, limit, most);
                if further != most {
                    (most, limit) = (further, in_f32(further - skipped, length));
                }
            }
        }
    }
}

/// A stretch of t as a length in f32, rounded up but finite: where nothing is, boxes are infinitely far away.
#[inline(always)]
fn in_f32(t: f64, length: f64) -> f32 {
    min((t * length) as f32 * (1.0 + 4.0 * f32::EPSILON), f32::MAX)
}

/// What a ray needs for the boxes.
struct Slabs {
    inverse: Vec3,
    /// origin × inverse.
    offset: Vec3,
}

impl Slabs {
    #[inline(always)]
    fn new(ray: &Ray32) -> Self {
        // Not infinite, since 0 × infinity is no number.
        let inverse = (1.0 / ray.direction).clamp(Vec3::splat(-1e18), Vec3::splat(1e18));
        Self { inverse, offset: ray.origin * inverse }
    }
}

impl Node {
    /// Adds the boxes that the ray meets before `limit` to those that wait.
    #[inline(always)]
    fn open(&self, slabs: &Slabs, limit: f32, waiting: &mut Waiting) {
        let Slabs { inverse, offset } = *slabs;
        let [low, high] = &self.sides;
        let mut entered = [0.0f32; LANES];
        let mut is_met = [false; LANES];
        for k in 0..LANES {
            let x = [low[0].0[k] * inverse.x - offset.x, high[0].0[k] * inverse.x - offset.x];
            let y = [low[1].0[k] * inverse.y - offset.y, high[1].0[k] * inverse.y - offset.y];
            let z = [low[2].0[k] * inverse.z - offset.z, high[2].0[k] * inverse.z - offset.z];
            let from = max(max(min(x[0], x[1]), min(y[0], y[1])), max(min(z[0], z[1]), 0.0));
            let to = min(min(max(x[0], x[1]), max(y[0], y[1])), min(max(z[0], z[1]), limit));
            entered[k] = from;
            is_met[k] = from <= to;
        }
        let first = waiting.count;
        for k in Mask::of(is_met) {
            let new = (self.children[k], entered[k]);
            let mut place = waiting.count;
            while place > first && waiting.boxes[place - 1].1 < new.1 {
                waiting.boxes[place] = waiting.boxes[place - 1];
                place -= 1;
            }
            waiting.boxes[place] = new;
            waiting.count += 1;
        }
    }
}

/// Builds the tree from one of two boxes a node.
struct Builder<'a> {
    binary: &'a BoxTree,
    boxes: &'a [Aabb],
    /// The most items in a leaf.
    most: usize,
}

/// Some items, and the box around them.
struct Branch {
    items: Vec<u32>,
    bounds: Aabb,
    /// Their box in the binary tree, if they are all that it holds.
    index: Option<usize>,
}

impl Builder<'_> {
    /// Adds the node of a branch and all below it, which is up to so many levels of nodes.
    fn node(&self, tree: &mut WideTree, branch: Branch, levels: u32) -> Child {
        let number = tree.nodes.len();
        tree.nodes
            .push(Node { sides: [[Lanes::all(f32::INFINITY); 3]; 2], children: [Child::NOTHING; LANES] });
        let parts = if branch.items.len() > self.most * LANES.pow(levels - 1) {
            self.eighths(&branch.items)
        } else {
            self.widened(branch)
        };
        for (lane, part) in parts.into_iter().enumerate() {
            // Covers the rounding of places in f32 and of the slab test.
            let padded = part.bounds.moved(-tree.centre).grown(4.0 * f64::from(ROUNDING) * tree.reach);
            let child = if part.items.len() <= self.most {
                tree.leaves.push(part.items);
                Child((tree.leaves.len() - 1) as u32 | Child::LEAF)
            } else {
                self.node(tree, part, levels - 1)
            };
            let node = &mut tree.nodes[number];
            for axis in 0..3 {
                node.sides[0][axis].0[lane] = padded.low[axis] as f32;
                node.sides[1][axis].0[lane] = padded.high[axis] as f32;
            }
            node.children[lane] = child;
        }
        Child(number as u32)
    }

    /// Up to eight branches that together hold what a branch holds: the largest is parted until there are eight, even if it would
    /// fit in a leaf, since a node tests eight boxes at the cost of one.
    fn widened(&self, root: Branch) -> Vec<Branch> {
        let mut open = vec![root];
        while open.len() < LANES {
            let many = open.iter().enumerate().filter(|(_, branch)| branch.items.len() > 1);
            let Some((place, _)) = many.max_by(|a, b| half_area(a.1).total_cmp(&half_area(b.1))) else {
                break;
            };
            let parted = self.parted(open.swap_remove(place));
            open.extend(parted);
        }
        open
    }

    fn parted(&self, branch: Branch) -> [Branch; 2] {
        if let Some(Inside::Boxes(halves)) = branch.index.map(|index| self.binary.inside(index)) {
            return halves.map(|half| self.branch(half));
        }
        let (left, right) = branch.items.split_at(branch.items.len() / 2);
        [left, right].map(|items| self.of_items(items))
    }

    /// These items in eight branches of the same number.
    fn eighths(&self, items: &[u32]) -> Vec<Branch> {
        items.chunks(items.len().div_ceil(LANES)).map(|items| self.of_items(items)).collect()
    }

    fn of_items(&self, items: &[u32]) -> Branch {
        let bounds = items.iter().map(|&item| self.boxes[item as usize]).fold(Aabb::EMPTY, Aabb::union);
        Branch { items: items.to_vec(), bounds, index: None }
    }

    /// What a box of the binary tree holds.
    fn branch(&self, index: usize) -> Branch {
        let mut items = vec![];
        self.gather(index, &mut items);
        Branch { items, bounds: self.binary.node(index).bounds, index: Some(index) }
    }

    fn gather(&self, index: usize, items: &mut Vec<u32>) {
        match self.binary.inside(index) {
            Inside::Things(things) => items.extend_from_slice(things),
            Inside::Boxes(halves) => halves.into_iter().for_each(|half| self.gather(half, items)),
        }
    }
}

/// Half the area of a branch's box.
fn half_area(branch: &Branch) -> f64 {
    let size = branch.bounds.size();
    size.x * size.y + size.y * size.z + size.z * size.x
}

#[cfg(test)]
mod tests {
    use super::super::shapes::point;
    use super::*;
    use proptest::prelude::*;

    /// The levels of nodes below a child, itself included.
    fn levels(tree: &WideTree, child: Child) -> u32 {
        if child.0 & Child::LEAF != 0 {
            return 0;
        }
        let children = tree.nodes[child.0 as usize].children;
        1 + children.into_iter().map(|child| levels(tree, child)).max().unwrap()
    }

    proptest! {
        /// Boxes each half as large as the last, which the binary tree takes off one by one, or boxes anywhere. So few,
        /// since obvhs checks its own depth in debug builds and is one off beyond 96.
        #[test]
        fn a_tree_holds_every_item_once_in_the_levels_it_may_have(
            corners in prop::collection::vec(point(), 1..90),
            (shrinks, spare, most) in (any::<bool>(), 0..3_u32, 1..9_usize),
        ) {
            let scale = |k: usize| if shrinks { 0.5f64.powi(k as i32) } else { 1.0 };
            let boxes: Vec<Aabb> = corners
                .iter()
                .enumerate()
                .map(|(k, &corner)| Aabb::around([corner * scale(k), (corner + 0.1) * scale(k)]))
                .collect();
            let mut tree = WideTree::new(&[], most);
            let binary = BoxTree::new(&boxes);
            let builder = Builder { binary: &binary, boxes: &boxes, most };
            let least = (1..).find(|&levels| boxes.len() <= most * LANES.pow(levels)).unwrap();
            let root = builder.node(&mut tree, builder.branch(binary.root().unwrap()), least + spare);
            prop_assert!(levels(&tree, root) <= least + spare);
            prop_assert!(tree.leaves.iter().all(|items| items.len() <= most));
            let mut items = tree.leaves.concat();
            items.sort_unstable();
            prop_assert_eq!(items, (0..boxes.len() as u32).collect::<Vec<_>>());
        }
    }
}
