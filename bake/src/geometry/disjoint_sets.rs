//! Disjoint sets of consecutive numbers, joined pair by pair (union-find with path halving; Tarjan 1975).

/// Sets that start as single numbers.
#[derive(Debug, Clone)]
pub struct DisjointSets {
    parent: Vec<usize>,
}

impl DisjointSets {
    /// The numbers below `count`, each a set of its own.
    pub fn new(count: usize) -> Self {
        Self { parent: (0..count).collect() }
    }

    /// The smallest number in the set of `i`.
    pub fn root(&mut self, mut i: usize) -> usize {
        while self.parent[i] != i {
            self.parent[i] = self.parent[self.parent[i]];
            i = self.parent[i];
        }
        i
    }

    /// Joins the sets of `i` and `j`.
    pub fn join(&mut self, i: usize, j: usize) {
        let (i, j) = (self.root(i), self.root(j));
        self.parent[i.max(j)] = i.min(j);
    }

    /// The sets, by their smallest number; numbers in each set rise.
    pub fn into_sets(mut self) -> Vec<Vec<usize>> {
        let mut sets = vec![vec![]; self.parent.len()];
        for i in 0..self.parent.len() {
            sets[self.root(i)].push(i);
        }
        sets.retain(|set| !set.is_empty());
        sets
    }
}
