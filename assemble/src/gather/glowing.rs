//! Emitting surfaces as few large polygons. Input: the placed parts and the emission of their elements. Output:
//! senders that cover the emitting elements, each with uniform emission.

use crate::placed_parts::PlacedParts;
use equilux_bake::elements::clusters::hierarchy;
use equilux_formats::{ClusterTree, Corners, Element, Rgb};

/// Emitting polygons, their hierarchy and their emission.
#[derive(Debug)]
pub struct EmittingSurfaces {
    /// Polygons in faces of the world.
    pub elements: Vec<Element>,
    /// The hierarchy of the elements.
    pub clusters: ClusterTree,
    /// W/m², one row an element.
    pub emission: Vec<Rgb>,
    /// For each element of the scene the polygon that covers it; u32::MAX if it does not emit.
    pub of_element: Vec<u32>,
}

/// All emitting surfaces. `emission`: W/m², one row an element.
pub fn surfaces(placed: &PlacedParts, emission: &[Rgb]) -> EmittingSurfaces {
    let mut found: Vec<(Element, Rgb)> = Vec::new();
    let mut of_element = vec![u32::MAX; placed.world.elements.len()];
    for k in 0..placed.instances.len() {
        let clusters = &placed.part_of(k).part.geometry.clusters;
        let own = &emission[placed.world.elements_of(k)];
        let mut open: Vec<usize> = clusters.root().into_iter().collect();
        while let Some(node) = open.pop() {
            match uniform(clusters, own, node) {
                Some(Rgb::BLACK) => {}
                Some(sends) if let Some(polygon) = polygon(placed, k, node) => {
                    let first = placed.world.elements_of(k).start;
                    clusters.spread(node, &mut |element, _| of_element[first + element] = found.len() as u32);
                    found.push((polygon, sends));
                }
                _ => {
                    let children =
                        clusters.children_of(node).expect("an element is a polygon of one emission");
                    open.extend(children.map(|child| child as usize));
                }
            }
        }
    }
    let elements: Vec<Element> = found.iter().map(|(element, _)| *element).collect();
    if elements.is_empty() {
        let clusters = ClusterTree::new(&[], vec![]).expect("nothing is a tree");
        return EmittingSurfaces { elements, clusters, emission: vec![], of_element };
    }
    let (order, clusters) = hierarchy(&elements);
    let mut place = vec![0; order.len()];
    order.iter().enumerate().for_each(|(k, &i)| place[i] = k as u32);
    let emitting = of_element.iter_mut().filter(|number| **number != u32::MAX);
    emitting.for_each(|number| *number = place[*number as usize]);
    let (elements, emission) = order.into_iter().map(|i| found[i]).unzip();
    EmittingSurfaces { elements, clusters, emission, of_element }
}

/// The emission of all elements of a node, if it is uniform.
fn uniform(clusters: &ClusterTree, emission: &[Rgb], node: usize) -> Option<Rgb> {
    let Some([left, right]) = clusters.children_of(node) else { return Some(emission[node]) };
    let left = uniform(clusters, emission, left as usize)?;
    (uniform(clusters, emission, right as usize)? == left).then_some(left)
}

/// A node of an instance as an element, if it is a polygon with three or four corners.
fn polygon(placed: &PlacedParts, instance: usize, node: usize) -> Option<Element> {
    let world = &placed.world;
    let number = world.nodes_of(instance).start + node;
    if let Some(element) = world.element_of(number) {
        return Some(world.elements[element]);
    }
    let node = &world.nodes[number];
    let side = node.side?;
    let corners = match node.polygon[..] {
        [a, b, c] => Corners::triangle([a, b, c]),
        [a, b, c, d] => Corners::quad([a, b, c, d]),
        _ => return None,
    };
    Some(Element::new(corners, side.material, side.face))
}
