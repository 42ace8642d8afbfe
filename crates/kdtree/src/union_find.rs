//! Disjoint sets that are united step by step.

/// Disjoint sets of numbers; the least of each represents it.
#[derive(Debug)]
pub(crate) struct UnionFind {
    parent: Vec<u32>,
}

impl UnionFind {
    /// Sets of one number each, from 0.
    pub(crate) fn new(n: usize) -> Self {
        Self { parent: (0..n as u32).collect() }
    }

    /// The least number of the set that `i` is in.
    pub(crate) fn root(&mut self, mut i: u32) -> u32 {
        while self.parent[i as usize] != i {
            let above = self.parent[i as usize];
            self.parent[i as usize] = self.parent[above as usize];
            i = above;
        }
        i
    }

    /// Unites the sets of two numbers.
    pub(crate) fn join(&mut self, a: u32, b: u32) {
        let (a, b) = (self.root(a), self.root(b));
        self.parent[a.max(b) as usize] = a.min(b);
    }
}
