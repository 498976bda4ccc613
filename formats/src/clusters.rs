//! The hierarchy of a part's elements: clusters represent groups of small, distant elements.
//!
//! Nodes are numbered: first the elements, then the clusters, every cluster before the clusters inside it. The first
//! cluster contains all elements.

use crate::rgb::Rgb;

/// A binary tree over a part's elements.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct ClusterTree {
    children: Vec<[u32; 2]>,
    /// Area of every node, elements first, m².
    areas: Vec<f64>,
    /// The cluster around every node; its own number for the root.
    parents: Vec<u32>,
}

impl ClusterTree {
    /// The tree over elements of the given areas (m²) from the two children of each cluster. Fails with a reason if
    /// these do not form a tree.
    pub fn new(element_areas: &[f64], children: Vec<[u32; 2]>) -> Result<Self, String> {
        let elements = element_areas.len();
        let nodes = elements + children.len();
        if children.len() + 1 != elements.max(1) {
            return Err(format!("{} clusters over {elements} elements", children.len()));
        }
        let mut areas = element_areas.to_vec();
        areas.resize(nodes, 0.0);
        let mut parents: Vec<u32> = (0..nodes as u32).collect();
        for (cluster, pair) in children.iter().enumerate().rev() {
            let node = elements + cluster;
            for &child in pair {
                let fits = (child as usize) < elements || (child as usize > node && (child as usize) < nodes);
                if !fits || parents[child as usize] != child {
                    return Err(format!("cluster {cluster} cannot hold node {child}"));
                }
                parents[child as usize] = node as u32;
                areas[node] += areas[child as usize];
            }
        }
        Ok(Self { children, areas, parents })
    }

    /// Elements of the given areas (m²) without clusters.
    pub fn flat(areas: Vec<f64>) -> Self {
        Self { children: vec![], parents: (0..areas.len() as u32).collect(), areas }
    }

    /// One tree over several: their elements one after the other, then clusters that join the trees, then the trees'
    /// own clusters. Empty trees add nothing.
    pub fn joined(trees: &[&Self]) -> Self {
        let trees: Vec<&&Self> = trees.iter().filter(|tree| tree.elements() > 0).collect();
        let areas: Vec<f64> = trees.iter().flat_map(|tree| &tree.areas[..tree.elements()]).copied().collect();
        let mut first_cluster = areas.len() + trees.len().saturating_sub(1);
        let (mut first_element, mut roots, mut inner) = (0, vec![], vec![]);
        for tree in &trees {
            let count = tree.elements();
            let number = |node: usize| {
                (if node < count { first_element + node } else { first_cluster + node - count }) as u32
            };
            roots.push(number(tree.root().expect("the tree is not empty")));
            inner.extend(tree.children.iter().map(|pair| pair.map(|child| number(child as usize))));
            first_element += count;
            first_cluster += tree.children.len();
        }
        let mut children: Vec<[u32; 2]> = (0..roots.len().saturating_sub(1))
            .map(|k| {
                let rest = if k + 2 == roots.len() { roots[k + 1] } else { (areas.len() + k + 1) as u32 };
                [roots[k], rest]
            })
            .collect();
        children.extend(inner);
        Self::new(&areas, children).expect("trees under a tree make a tree")
    }

    /// Number of elements.
    pub fn elements(&self) -> usize {
        self.areas.len() - self.children.len()
    }

    /// Number of elements and clusters.
    pub fn nodes(&self) -> usize {
        self.areas.len()
    }

    /// The root node; none in an empty tree. A flat tree has none either, unless it has one element.
    pub fn root(&self) -> Option<usize> {
        match self.elements() {
            0 => None,
            1 => Some(0),
            elements => (!self.children.is_empty()).then_some(elements),
        }
    }

    /// The two nodes inside a cluster; none for an element.
    pub fn children_of(&self, node: usize) -> Option<[u32; 2]> {
        node.checked_sub(self.elements()).map(|cluster| self.children[cluster])
    }

    /// The two children of every cluster.
    pub fn children(&self) -> &[[u32; 2]] {
        &self.children
    }

    /// The cluster around a node; none for the root.
    pub fn parent_of(&self, node: usize) -> Option<usize> {
        let parent = self.parents[node] as usize;
        (parent != node).then_some(parent)
    }

    /// Area of a node, m².
    pub fn area_of(&self, node: usize) -> f64 {
        self.areas[node]
    }

    /// Appends to `nodes` the value of every node: those of the elements, then the area-weighted mean of each cluster.
    pub fn append_means(&self, elements: &[Rgb], nodes: &mut Vec<Rgb>) {
        assert_eq!(elements.len(), self.elements(), "a value an element");
        let base = nodes.len();
        nodes.extend_from_slice(elements);
        nodes.resize(base + self.nodes(), Rgb::BLACK);
        for (cluster, pair) in self.children.iter().enumerate().rev() {
            let node = self.elements() + cluster;
            let [left, right] = pair.map(|child| child as usize);
            let share = self.areas[left] / self.areas[node];
            let (l, r) = (nodes[base + left], nodes[base + right]);
            nodes[base + node] = r + (l - r) * share;
        }
    }

    /// Appends to `nodes` an upper bound of the deviation of element values inside each node from its mean; zero for
    /// elements. `means` holds the values of all nodes.
    pub fn append_spreads(&self, means: &[Rgb], nodes: &mut Vec<Rgb>) {
        let mut ranges: Vec<[Rgb; 2]> = means.iter().map(|&value| [value; 2]).collect();
        for (cluster, pair) in self.children.iter().enumerate().rev() {
            let [left, right] = pair.map(|child| ranges[child as usize]);
            ranges[self.elements() + cluster] = [left[0].min(right[0]), left[1].max(right[1])];
        }
        let spread = |(&mean, [low, high]): (&Rgb, [Rgb; 2])| (high - mean).max(mean - low);
        nodes.extend(means.iter().zip(ranges).map(spread));
    }

    /// The values of all nodes, from those of the elements.
    pub fn means(&self, elements: &[Rgb]) -> Vec<Rgb> {
        let mut nodes = Vec::with_capacity(self.nodes());
        self.append_means(elements, &mut nodes);
        nodes
    }

    /// Calls `visit` with every element of a node and its share of the node's area.
    pub fn spread(&self, node: usize, visit: &mut impl FnMut(usize, f64)) {
        let mut open = vec![node];
        while let Some(inner) = open.pop() {
            match self.children_of(inner) {
                None => visit(inner, self.areas[inner] / self.areas[node]),
                Some([left, right]) => open.extend([right as usize, left as usize]),
            }
        }
    }
}
