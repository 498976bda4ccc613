//! Flattens a document's node hierarchy: its nodes in order of their names, each with its placement and its extras. So two files
//! that differ in the order of nodes alone are the same scene to the bit: sums of light, and which of two surfaces at one
//! place is met, follow the order of instances. Nothing here recurses, so a chain of a million nodes is read like any other
//! file.

use super::document::{Document, label};
use super::extras::Extras;
use super::notes::Notes;
use super::repaint::{Look, Repaint};
use equilux_formats::{Result, TexelChoice};
use glam::{DAffine3, DMat4, DQuat, DVec3};
use gltf::Node;
use gltf::scene::Transform;
use std::cmp::Ordering;
use std::rc::Rc;

/// A node with the properties it inherits from the nodes above it.
#[derive(Clone)]
pub(super) struct PlacedNode<'a> {
    pub(super) node: Node<'a>,
    pub(super) extras: Extras,
    /// Node coordinates → coordinates of the start of the walk.
    pub(super) placement: DAffine3,
    /// The material changes of the nodes from the start of the walk to this one.
    pub(super) look: Look,
    /// What these nodes choose for texels; the last one decides.
    pub(super) texels: TexelChoice,
}

impl<'a> PlacedNode<'a> {
    /// The same node as the start of a walk.
    pub(super) fn as_origin(&self) -> Self {
        Self {
            placement: DAffine3::IDENTITY,
            look: Look::default(),
            texels: TexelChoice::default(),
            ..self.clone()
        }
    }

    /// The name of the node.
    pub(super) fn name(&self) -> String {
        label(&self.node)
    }

    fn child(&self, document: &Document, node: Node<'a>) -> Result<Self> {
        let extras = Extras::of(document, &node)?;
        let placement = self.placement * local_transform(document, &node)?;
        if !placement.is_finite() {
            return Err(document.error(
                format!("node {} with a transform too large to compute with", label(&node)),
                "coordinates of a few kilometres at most",
                "correct the scales of the node and of those above it",
            ));
        }
        let mut look = self.look.clone();
        look.emission_scale *= extras.emission_scale.unwrap_or(1.0);
        let repaint = |changes: &_| Rc::new(Repaint::new(&node, label(&node), changes));
        look.repaints.extend(extras.materials.as_ref().map(repaint));
        let texels = extras.texels.or(self.texels);
        Ok(Self { node, extras, placement, look, texels })
    }
}

/// The root nodes of the scene with their own transforms, without those that are ignored. Fails unless the hierarchy is a tree.
pub(super) fn roots<'a>(document: &'a Document, notes: &mut Notes) -> Result<Vec<PlacedNode<'a>>> {
    let roots = root_nodes(document);
    check_tree(document, &roots, notes)?;
    roots.first().map(above_roots).map_or(Ok(vec![]), |above| below(document, &above, roots.iter().cloned()))
}

fn above_roots<'a>(any: &Node<'a>) -> PlacedNode<'a> {
    PlacedNode {
        node: any.clone(),
        extras: Extras::default(),
        placement: DAffine3::IDENTITY,
        look: Look::default(),
        texels: TexelChoice::default(),
    }
}

/// The nodes that are parts: the roots, or the children of a root that only wraps the whole scene.
pub(super) fn part_roots<'a>(document: &'a Document, notes: &mut Notes) -> Result<Vec<PlacedNode<'a>>> {
    let mut roots = roots(document, notes)?;
    while let [wrapper] = roots.as_slice()
        && is_wrapper(wrapper)
    {
        roots = children(document, wrapper)?;
    }
    Ok(roots)
}

fn is_wrapper(placed: &PlacedNode) -> bool {
    let node = &placed.node;
    let holds = node.mesh().is_some() || node.camera().is_some() || node.light().is_some();
    !holds && !placed.extras.any() && node.children().len() > 0
}

/// `start` and all nodes below it, parents before children. Nodes below a node with a `part` are left out: the part
/// file replaces them.
pub(super) fn subtree<'a>(document: &'a Document, start: PlacedNode<'a>) -> Result<Vec<PlacedNode<'a>>> {
    let (mut visited, mut open) = (Vec::new(), vec![start]);
    while let Some(placed) = open.pop() {
        if placed.extras.part.is_none() {
            open.extend(children(document, &placed)?.into_iter().rev());
        }
        visited.push(placed);
    }
    Ok(visited)
}

fn children<'a>(document: &Document, parent: &PlacedNode<'a>) -> Result<Vec<PlacedNode<'a>>> {
    below(document, parent, parent.node.children())
}

/// These nodes below `parent`, without those that are ignored.
fn below<'a>(
    document: &Document,
    parent: &PlacedNode<'a>,
    nodes: impl Iterator<Item = Node<'a>>,
) -> Result<Vec<PlacedNode<'a>>> {
    let placed = nodes.map(|node| parent.child(document, node));
    let placed: Result<Vec<_>> =
        placed.filter(|placed| placed.as_ref().map_or(true, |placed| !placed.extras.ignored())).collect();
    Ok(in_order(placed?))
}

/// Nodes by name; of the same name, by placement, and then by what they show.
fn in_order(mut nodes: Vec<PlacedNode>) -> Vec<PlacedNode> {
    let placed = |node: &PlacedNode| node.placement.to_cols_array();
    let shown = |PlacedNode { node, .. }: &PlacedNode| {
        let mesh = node.mesh().map(|mesh| mesh.index());
        (mesh, node.light().map(|light| light.index()), node.camera().map(|camera| camera.index()))
    };
    nodes.sort_by(|a, b| {
        let places = placed(a).into_iter().zip(placed(b)).map(|(a, b)| a.total_cmp(&b));
        let by_name = a.node.name().cmp(&b.node.name());
        by_name.then(places.fold(Ordering::Equal, Ordering::then)).then_with(|| shown(a).cmp(&shown(b)))
    });
    nodes
}

fn root_nodes(document: &Document) -> Vec<Node<'_>> {
    let gltf = &document.gltf;
    match gltf.default_scene().or_else(|| gltf.scenes().next()) {
        Some(scene) => scene.nodes().collect(),
        None => {
            let mut is_child = vec![false; gltf.nodes().len()];
            gltf.nodes().flat_map(|node| node.children()).for_each(|child| is_child[child.index()] = true);
            gltf.nodes().filter(|node| !is_child[node.index()]).collect()
        }
    }
}

/// Walks the whole hierarchy and fails if a node occurs twice, as its own ancestor or below a second parent: later
/// walks would not end, or could grow without bounds. Notes the nodes that are ignored.
fn check_tree(document: &Document, roots: &[Node], notes: &mut Notes) -> Result<()> {
    let mut parent_of: Vec<Option<Option<usize>>> = vec![None; document.gltf.nodes().len()];
    let mut open: Vec<(Node, Option<usize>)> = roots.iter().map(|root| (root.clone(), None)).collect();
    while let Some((node, parent)) = open.pop() {
        if parent_of[node.index()].is_some() {
            let ancestors = std::iter::successors(parent, |&at| parent_of[at].flatten());
            let why = match ancestors.take(parent_of.len()).any(|ancestor| ancestor == node.index()) {
                true => "is below itself, a cycle",
                false => "hangs in two places",
            };
            return Err(document.error(
                format!("node {} {why}", label(&node)),
                "a tree of nodes, each with one parent",
                "remove the node from all but one list of children",
            ));
        }
        parent_of[node.index()] = Some(parent);
        if Extras::of(document, &node)?.ignored() {
            notes.add(label(&node), "ignored with all below, as \"bake\": false in the extras asks");
            continue;
        }
        open.extend(node.children().map(|child| (child, Some(node.index()))));
    }
    Ok(())
}

/// Node coordinates → its parent's. In f64 and with a normalised quaternion, for rotations that keep lengths.
fn local_transform(document: &Document, node: &Node) -> Result<DAffine3> {
    let wrong = |found: &str, expected: &str| {
        document.error(format!("node {} with {found}", label(node)), expected, "apply the node's transform")
    };
    let transform = match node.transform() {
        Transform::Matrix { matrix } => {
            let matrix = DMat4::from_cols_array_2d(&matrix.map(|column| column.map(f64::from)));
            if matrix.row(3).to_array() != [0.0, 0.0, 0.0, 1.0] {
                return Err(wrong("a projective matrix", "a fourth row of 0 0 0 1"));
            }
            DAffine3::from_mat4(matrix)
        }
        Transform::Decomposed { translation, rotation, scale } => {
            let rotation = DQuat::from_array(rotation.map(f64::from));
            if !(rotation.length() > 0.0 && rotation.is_finite()) {
                return Err(wrong("a rotation that is no quaternion", "a unit quaternion"));
            }
            let vector = |components: [f32; 3]| DVec3::from_array(components.map(f64::from));
            DAffine3::from_scale_rotation_translation(
                vector(scale),
                rotation.normalize(),
                vector(translation),
            )
        }
    };
    match transform.is_finite() {
        true => Ok(transform),
        false => Err(wrong("a transform that is not finite", "finite numbers")),
    }
}
