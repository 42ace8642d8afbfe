//! Equal trees, stored once.
//!
//! Two nodes with the same gate, the same children and the same mark are one. Children come before their parents,
//! so their ids are known when the parent is looked up, and equal trees have equal ids from the leaves up: the
//! result is the smallest graph that unfolds to the trees (for nodes that carry their gate).
//!
//! Source: hash-consing (Ershov, Comm. ACM 1(8), 1958); smallest automata of finite sets of words, built so: Daciuk,
//! Mihov, Watson and Watson, Comput. Linguist. 26(1), 2000.

use std::collections::HashMap;

/// Nodes, each stored once.
#[derive(Debug, Default)]
pub(super) struct Shared {
    pub(super) gates: Vec<u32>,
    /// Ends of the lists of children; each begins where the one before ends.
    ends: Vec<u32>,
    pub(super) children: Vec<u32>,
    pub(super) open: Vec<bool>,
    /// The last node with each hash. Never iterated.
    last: HashMap<u64, u32>,
    /// The previous node with the same hash.
    before: Vec<u32>,
}

const NONE: u32 = u32::MAX;

fn hash(gate: u32, open: bool, children: &[u32]) -> u64 {
    // Steps of a multiplicative hash; the map mixes once more.
    let step = |h: u64, x: u64| (h.rotate_left(5) ^ x).wrapping_mul(0x517C_C1B7_2722_0A95);
    children.iter().fold(step(u64::from(gate), u64::from(open)), |h, &c| step(h, u64::from(c)))
}

impl Shared {
    pub(super) fn len(&self) -> usize {
        self.gates.len()
    }

    pub(super) fn children(&self, node: u32) -> &[u32] {
        let node = node as usize;
        let first = node.checked_sub(1).map_or(0, |i| self.ends[i]);
        &self.children[first as usize..self.ends[node] as usize]
    }

    /// Where the children of each node begin, and where the last ones end.
    pub(super) fn first_child(&self) -> Vec<u32> {
        [0].into_iter().chain(self.ends.iter().copied()).collect()
    }

    /// The id of a node, new or not. `children` are distinct ids, ascending.
    pub(super) fn id(&mut self, gate: u32, open: bool, children: &[u32]) -> u32 {
        let hash = hash(gate, open, children);
        let last = self.last.get(&hash).copied().unwrap_or(NONE);
        let mut at = last;
        while at != NONE {
            let i = at as usize;
            if self.gates[i] == gate && self.open[i] == open && self.children(at) == children {
                return at;
            }
            at = self.before[i];
        }
        let new = self.gates.len() as u32;
        self.gates.push(gate);
        self.open.push(open);
        self.children.extend_from_slice(children);
        self.ends.push(self.children.len() as u32);
        self.before.push(last);
        self.last.insert(hash, new);
        new
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equal_nodes_are_one_and_others_are_not() {
        let mut shared = Shared::default();
        let leaf = shared.id(3, false, &[]);
        let open = shared.id(3, true, &[]);
        assert_ne!(leaf, open);
        let parent = shared.id(5, false, &[leaf]);
        let others = [shared.id(5, false, &[open]), shared.id(5, false, &[leaf, open]), shared.id(7, false, &[leaf])];
        assert!(others.iter().all(|&other| other != parent));
        assert_eq!((shared.id(3, false, &[]), shared.id(5, false, &[leaf])), (leaf, parent));
        assert_eq!((shared.len(), shared.children(others[1])), (6, &[leaf, open][..]));
        assert_eq!(shared.first_child(), [0, 0, 0, 1, 2, 4, 5]);
    }
}
