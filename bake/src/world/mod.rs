//! Elements, clusters and faces of one or more instances in one coordinate system: the input of form-factor computations.

pub mod occluders;

use crate::geometry::aabb::Aabb;
use crate::geometry::planes;
use crate::geometry::polygon::{Polygon, area, convex_hull};
use crate::geometry::solids::lit_behind;
use crate::geometry::tolerance::SAME_AREA;
use equilux_formats::{ClusterTree, Element, Face, FaceId, Geometry, MaterialId};
use glam::{DAffine3, DVec3};
use occluders::Occluders;
use std::ops::Range;
use std::sync::OnceLock;

/// Placed geometry and its occluders.
#[derive(Debug)]
pub struct World {
    /// All elements, instance after instance; `face` counts through [`World::faces`].
    pub elements: Vec<Element>,
    /// All faces, which block light.
    pub faces: Vec<Face>,
    planes: FacePlanes,
    /// All elements and clusters, instance after instance, numbered within an instance as its tree numbers them.
    pub nodes: Vec<Sender>,
    /// The occluders, in a spatial index, once they are asked for: rays need none.
    occluders: OnceLock<Occluders>,
    instances: Vec<InstanceRanges>,
    /// The cluster around every node; its own number for a root.
    parents: Vec<u32>,
}

/// The planes that faces lie in, by number, and the instances they belong to.
#[derive(Debug)]
struct FacePlanes {
    /// Once they are asked for.
    in_scene: OnceLock<Vec<u32>>,
    in_part: Vec<u32>,
    instance: Vec<u32>,
}

/// The ranges of an instance's elements and nodes.
#[derive(Debug, Clone, PartialEq)]
struct InstanceRanges {
    elements: Range<usize>,
    nodes: Range<usize>,
    root: Option<usize>,
}

/// An element or cluster as a sender.
#[derive(Debug, Clone)]
pub struct Sender {
    /// The box around it.
    pub bounds: Aabb,
    /// Area, m².
    pub area: f64,
    /// The children of a cluster; none for an element.
    pub children: Option<[u32; 2]>,
    /// The side of a face that all its elements lie on; none if they lie on several.
    pub side: Option<FaceSide>,
    /// Its outline, if it is a planar convex polygon; elements always are. Empty if not.
    pub polygon: Polygon,
}

/// One side of a face.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FaceSide {
    /// The face.
    pub face: FaceId,
    /// Unit normal of this side.
    pub normal: DVec3,
    /// The material of its elements: surfaces of different materials are never one sender.
    pub material: MaterialId,
}

impl FaceSide {
    fn is_as(&self, other: Self) -> bool {
        self.face == other.face && self.material == other.material && self.normal.dot(other.normal) > 0.0
    }
}

impl World {
    /// Builds the world of these geometries, each with its placement (a similarity).
    pub fn new<'a>(placed: impl IntoIterator<Item = (&'a Geometry, DAffine3)>) -> Self {
        let (mut elements, mut faces, mut nodes, mut instances) = (vec![], vec![], vec![], vec![]);
        let (mut in_part, mut instance) = (vec![], vec![]);
        for (geometry, placement) in placed {
            let (first_element, first_face, first_node) = (elements.len(), faces.len() as u32, nodes.len());
            elements.extend(geometry.elements.iter().map(|e| place_element(e, placement, first_face)));
            faces.extend(geometry.faces.iter().map(|face| place_face(face, placement)));
            in_part.extend(planes::group(&geometry.faces));
            instance.resize(faces.len(), instances.len() as u32);
            add_senders(&geometry.clusters, &elements[first_element..], &mut nodes);
            instances.push(InstanceRanges {
                elements: first_element..elements.len(),
                nodes: first_node..nodes.len(),
                root: geometry.clusters.root().map(|root| first_node + root),
            });
        }
        let planes = FacePlanes { in_scene: OnceLock::new(), in_part, instance };
        let parents = parents(&nodes);
        Self { elements, faces, planes, nodes, occluders: OnceLock::new(), instances, parents }
    }

    /// The occluders, in a spatial index.
    pub fn occluders(&self) -> &Occluders {
        self.occluders.get_or_init(|| Occluders::new(&self.faces, &lit_behind(&self.elements, &self.faces)))
    }

    /// The occluders alone.
    pub fn into_occluders(self) -> Occluders {
        self.occluders();
        self.occluders.into_inner().expect("just found")
    }

    fn planes_in_scene(&self) -> &[u32] {
        self.planes.in_scene.get_or_init(|| planes::group(&self.faces))
    }

    /// Adds senders that do not occlude: elements that lie in faces of the world. Returns their instance.
    pub fn add_senders(&mut self, elements: &[Element], clusters: &ClusterTree) -> usize {
        // Of what was there before.
        self.occluders();
        let (first_element, first_node) = (self.elements.len(), self.nodes.len());
        self.elements.extend_from_slice(elements);
        add_senders(clusters, elements, &mut self.nodes);
        self.instances.push(InstanceRanges {
            elements: first_element..self.elements.len(),
            nodes: first_node..self.nodes.len(),
            root: clusters.root().map(|root| first_node + root),
        });
        self.parents = parents(&self.nodes);
        self.instances.len() - 1
    }

    /// Adds geometry behind everything else that does not occlude, such as a sky. Returns its instance.
    pub fn add_far(&mut self, geometry: &Geometry) -> usize {
        self.occluders();
        self.planes_in_scene();
        let first = self.faces.len() as u32;
        self.faces.extend_from_slice(&geometry.faces);
        // Each face has a plane of its own: nothing lies in it.
        let FacePlanes { in_scene, in_part, instance } = &mut self.planes;
        let in_scene = in_scene.get_mut().expect("just found");
        let past = in_scene.iter().max().map_or(0, |last| last + 1);
        in_scene.extend((0..).take(geometry.faces.len()).map(|n| past + n));
        in_part.extend((0..).take(geometry.faces.len()));
        instance.resize(self.faces.len(), self.instances.len() as u32);
        let occluders = self.occluders.get_mut().expect("just found");
        occluders.of_face.resize(self.faces.len(), u32::MAX);
        let in_world = |e: &Element| Element { face: FaceId(e.face.0 + first), ..*e };
        let elements: Vec<Element> = geometry.elements.iter().map(in_world).collect();
        self.add_senders(&elements, &geometry.clusters)
    }

    /// Whether two faces lie in one plane, so that neither lights nor hides the other. Within an instance this is
    /// decided in the part's own coordinates, so that it is the same in every scene.
    pub fn coplanar(&self, a: FaceId, b: FaceId) -> bool {
        let FacePlanes { in_part, instance, .. } = &self.planes;
        let (a, b) = (a.index(), b.index());
        if instance[a] == instance[b] {
            in_part[a] == in_part[b]
        } else {
            self.planes_in_scene()[a] == self.planes_in_scene()[b]
        }
    }

    /// The number of the plane that a face lies in, among those of its instance.
    pub fn plane_of(&self, face: FaceId) -> u32 {
        self.planes.in_part[face.index()]
    }

    /// The elements of the `instance`-th geometry.
    pub fn elements_of(&self, instance: usize) -> Range<usize> {
        self.instances[instance].elements.clone()
    }

    /// The nodes of the `instance`-th geometry, elements first.
    pub fn nodes_of(&self, instance: usize) -> Range<usize> {
        self.instances[instance].nodes.clone()
    }

    /// The node that holds all of the `instance`-th geometry; none if it is empty.
    pub fn root_of(&self, instance: usize) -> Option<usize> {
        self.instances[instance].root
    }

    /// The cluster around a node; none for a root.
    pub fn parent_of(&self, node: u32) -> Option<u32> {
        Some(self.parents[node as usize]).filter(|&parent| parent != node)
    }

    /// Number of geometries.
    pub fn instances(&self) -> usize {
        self.instances.len()
    }

    /// The instance a node belongs to.
    pub fn instance_of_node(&self, node: usize) -> usize {
        self.instances.partition_point(|placed| placed.nodes.end <= node)
    }

    /// The node of an element.
    pub fn node_of(&self, element: usize) -> usize {
        let instance = self.instances.partition_point(|placed| placed.elements.end <= element);
        let placed = &self.instances[instance];
        element - placed.elements.start + placed.nodes.start
    }

    /// The element of a node, if it is one.
    pub fn element_of(&self, node: usize) -> Option<usize> {
        let placed = &self.instances[self.instance_of_node(node)];
        let number = node - placed.nodes.start;
        (number < placed.elements.len()).then(|| placed.elements.start + number)
    }
}

fn parents(nodes: &[Sender]) -> Vec<u32> {
    let mut parents: Vec<u32> = (0..nodes.len() as u32).collect();
    for (number, node) in nodes.iter().enumerate() {
        node.children.iter().flatten().for_each(|&child| parents[child as usize] = number as u32);
    }
    parents
}

/// A mirrored placement reverses the order of the corners, so that they stay counter-clockwise from the front.
pub(crate) fn place_element(element: &Element, placement: DAffine3, first_face: u32) -> Element {
    if placement == DAffine3::IDENTITY {
        return Element { face: FaceId(element.face.0 + first_face), ..*element };
    }
    let mut corners = element.corners.map(|p| placement.transform_point3(p));
    if placement.matrix3.determinant() < 0.0 {
        corners = corners.flipped();
    }
    Element::new(corners, element.material, FaceId(element.face.0 + first_face))
}

fn place_face(face: &Face, placement: DAffine3) -> Face {
    if placement == DAffine3::IDENTITY {
        return face.clone();
    }
    let mut corners: Vec<DVec3> = face.corners.iter().map(|&p| placement.transform_point3(p)).collect();
    if placement.matrix3.determinant() < 0.0 {
        corners.reverse();
    }
    Face::new(corners)
}

/// Appends the senders of one instance with these placed elements.
fn add_senders(tree: &ClusterTree, elements: &[Element], nodes: &mut Vec<Sender>) {
    let base = nodes.len();
    nodes.extend(elements.iter().map(element_sender));
    // Clusters precede their children, so this loop runs backwards.
    let mut clusters: Vec<Sender> = Vec::with_capacity(tree.nodes() - elements.len());
    let count = tree.nodes();
    for node in (elements.len()..count).rev() {
        let pair = tree.children_of(node).expect("a cluster has children");
        let child = |local: u32| {
            let local = local as usize;
            if local < elements.len() { &nodes[base + local] } else { &clusters[count - 1 - local] }
        };
        let inner = [child(pair[0]), child(pair[1])];
        clusters.push(cluster_sender(inner, pair.map(|local| base as u32 + local)));
    }
    clusters.reverse();
    nodes.extend(clusters);
}

fn element_sender(element: &Element) -> Sender {
    let corners = element.corners.as_slice();
    Sender {
        bounds: Aabb::around(corners),
        area: element.area,
        children: None,
        side: Some(FaceSide { face: element.face, normal: element.normal, material: element.material }),
        polygon: corners.iter().copied().collect(),
    }
}

fn cluster_sender([left, right]: [&Sender; 2], children: [u32; 2]) -> Sender {
    let side = match (left.side, right.side) {
        (Some(l), Some(r)) if l.is_as(r) => Some(l),
        _ => None,
    };
    let polygon = side.map_or_else(Polygon::new, |side| union(left, right, side.normal));
    Sender {
        bounds: left.bounds.union(right.bounds),
        area: left.area + right.area,
        children: Some(children),
        side,
        polygon,
    }
}

/// The union of two polygons in one plane if it is convex, else nothing: their convex hull, if it has their area.
fn union(left: &Sender, right: &Sender, normal: DVec3) -> Polygon {
    if left.polygon.is_empty() || right.polygon.is_empty() {
        return Polygon::new();
    }
    let hull = convex_hull(left.polygon.iter().chain(&right.polygon).copied(), normal);
    let area = area(&hull);
    if (area - left.area - right.area).abs() <= SAME_AREA * area { hull } else { Polygon::new() }
}
