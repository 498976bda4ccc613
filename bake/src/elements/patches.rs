//! Groups elements into patches, the unknowns of rows by rays: connected elements of one material that face about the same way
//! and together are no larger than an element may be. Elements of that size are patches of their own. Patches much smaller than
//! that, such as the leaves of a tree, become one if they lie together, connected or not.

use super::ElementSize;
use crate::geometry::aabb::Aabb;
use crate::geometry::point_key::{EdgeKey, edge_keys};
use equilux_formats::{Element, MaterialId, Patches};
use std::collections::{HashMap, VecDeque};

/// The diagonal of a patch in element sizes: a bit more than that of a square element, less than that of two.
const LARGEST: f64 = 1.5;

/// The cosine of the angle between the normals of a patch and that of its first element: 60°.
const MIN_COSINE: f64 = 0.5;

/// Patches with a diagonal below this many element sizes need not be connected to become one.
const TINY: f64 = 0.5;

/// The patches of a part's elements, of this size in the part's unit, for rows of so many rays.
pub fn patches(elements: &[Element], size: ElementSize, rays: u32) -> Patches {
    let of = match size {
        ElementSize::Metres(size) => {
            let connected = grouped(elements, LARGEST * size);
            gathered(elements, &connected, size)
        }
        ElementSize::Mesh => (0..elements.len() as u32).collect(),
    };
    Patches::new(of, elements, rays).expect("every patch has elements")
}

/// The patch of each element: in order, each that has none yet takes its neighbours, nearest first, while they fit.
fn grouped(elements: &[Element], largest: f64) -> Vec<u32> {
    const NONE: u32 = u32::MAX;
    let beside = neighbours(elements);
    let (mut of, mut count) = (vec![NONE; elements.len()], 0);
    for first in 0..elements.len() {
        if of[first] != NONE {
            continue;
        }
        let seed = &elements[first];
        let mut around = Aabb::around(seed.corners.as_slice());
        of[first] = count;
        let mut open = VecDeque::from([first]);
        while let Some(inner) = open.pop_front() {
            for &next in &beside[inner] {
                let element = &elements[next];
                let wider = around.union(Aabb::around(element.corners.as_slice()));
                let fits = element.material == seed.material
                    && element.normal.dot(seed.normal) >= MIN_COSINE
                    && wider.diagonal() <= largest;
                if of[next] == NONE && fits {
                    (of[next], around) = (count, wider);
                    open.push_back(next);
                }
            }
        }
        count += 1;
    }
    of
}

/// Where a tiny patch lies and what it is like: a cell of one element size, the axis that it faces most, and its material.
type Neighbourhood = ([i64; 3], usize, bool, MaterialId);

/// The patches with tiny ones of a neighbourhood joined, numbered in order of their first elements.
fn gathered(elements: &[Element], of: &[u32], size: f64) -> Vec<u32> {
    let mut around = vec![Aabb::EMPTY; of.iter().max().map_or(0, |&last| last as usize + 1)];
    for (&patch, element) in of.iter().zip(elements) {
        let bounds = &mut around[patch as usize];
        *bounds = bounds.union(Aabb::around(element.corners.as_slice()));
    }
    let neighbourhood = |element: &Element, bounds: &Aabb| -> Neighbourhood {
        let cell = (bounds.centre() / size).floor().to_array().map(|x| x as i64);
        let axis = element.normal.abs().max_position();
        (cell, axis, element.normal[axis] > 0.0, element.material)
    };
    let (mut joined, mut numbers): (HashMap<Neighbourhood, u32>, Vec<Option<u32>>) =
        (HashMap::new(), vec![None; around.len()]);
    let mut count = 0;
    let number = |(&patch, element): (&u32, &Element)| {
        let bounds = &around[patch as usize];
        *numbers[patch as usize].get_or_insert_with(|| {
            let mut next = || {
                count += 1;
                count - 1
            };
            if bounds.diagonal() < TINY * size {
                *joined.entry(neighbourhood(element, bounds)).or_insert_with(next)
            } else {
                next()
            }
        })
    };
    of.iter().zip(elements).map(number).collect()
}

/// The elements on the other side of each edge of each element.
fn neighbours(elements: &[Element]) -> Vec<Vec<usize>> {
    let mut at: HashMap<EdgeKey, Vec<usize>> = HashMap::new();
    for (number, element) in elements.iter().enumerate() {
        for (edge, _) in edge_keys(element.corners.as_slice()) {
            at.entry(edge).or_default().push(number);
        }
    }
    let beside = |(number, element): (usize, &Element)| {
        let edges = edge_keys(element.corners.as_slice());
        edges.flat_map(|(edge, _)| at[&edge].iter().copied()).filter(|&other| other != number).collect()
    };
    elements.iter().enumerate().map(beside).collect()
}
