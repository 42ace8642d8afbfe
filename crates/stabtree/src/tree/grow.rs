//! One tree, breadth first up to a number of nodes.
//!
//! Nodes are expanded in the order in which they were found, so that a limit cuts off the longest sequences. The
//! follower moves from node to node by way of their last common gate; as nodes of a level lie side by side, a level
//! costs no more pushes than the tree up to it has nodes, mostly far fewer, and memory is that of the nodes.

use super::follow::Follower;
use super::gate_graph::GateGraph;
use sightlines_cells::CellId;

/// A tree in breadth-first order: node 0 is the root, the children of a node lie side by side.
#[derive(Debug)]
pub(super) struct Grown {
    /// The gate crossed last; meaningless for the root.
    pub(super) gates: Vec<u32>,
    /// Where the children of each node begin; those of the next node follow.
    first_child: Vec<u32>,
    /// Nodes with sequences beyond them that are not in the tree. They have no children.
    pub(super) open: Vec<bool>,
    /// Number of undecided pushes.
    pub(super) n_undecided: u64,
}

impl Grown {
    pub(super) fn len(&self) -> usize {
        self.gates.len()
    }

    pub(super) fn children(&self, node: usize) -> std::ops::Range<usize> {
        let end = self.first_child.get(node + 1).map_or(self.len(), |&first| first as usize);
        self.first_child[node] as usize..end
    }
}

/// The position of the follower.
struct Place<N> {
    /// The parent of each node, and the follower's note of it.
    nodes: Vec<(u32, Option<N>)>,
    /// Nodes from below the root to the follower's position.
    path: Vec<u32>,
    way: Vec<u32>,
}

impl<N: Copy> Place<N> {
    /// Moves the follower to a node.
    fn go<F: Follower<Note = N>>(&mut self, node: u32, gates: &[u32], follower: &mut F) {
        self.way.clear();
        let mut at = node;
        while at != 0 {
            self.way.push(at);
            at = self.nodes[at as usize].0;
        }
        self.way.reverse();
        let common = self.path.iter().zip(&self.way).take_while(|(a, b)| a == b).count();
        while self.path.len() > common {
            self.path.pop();
            follower.pop();
        }
        for &next in &self.way[common..] {
            if let Some(note) = self.nodes[next as usize].1 {
                follower.push_again(gates[next as usize], note);
            }
            self.path.push(next);
        }
    }
}

/// Grows the tree of `root` up to `max_nodes` nodes, at least 1, the root included. What no longer fits ends in open
/// nodes; a node is open only if some sequence continues from it.
pub(super) fn grow<F: Follower>(ways: &GateGraph<'_>, root: CellId, follower: &mut F, max_nodes: usize) -> Grown {
    let undecided_before = follower.n_undecided();
    let mut tree = Grown { gates: vec![u32::MAX], first_child: Vec::new(), open: Vec::new(), n_undecided: 0 };
    let mut place = Place { nodes: vec![(0, None)], path: Vec::new(), way: Vec::new() };
    let (mut met, mut found) = (Vec::new(), Vec::new());
    let mut is_full = false;
    let mut node = 0;
    while node < tree.len() {
        place.go(node as u32, &tree.gates, follower);
        met.clear();
        met.push(root);
        met.extend(place.path.iter().map(|&n| ways.head(tree.gates[n as usize])));
        found.clear();
        let entry = place.path.last().map(|&n| tree.gates[n as usize]);
        for gate in ways.onward(&met, entry) {
            if let Some(note) = follower.push(gate) {
                follower.pop();
                found.push((gate, note));
                if is_full {
                    break;
                }
            }
        }
        is_full |= tree.len() + found.len() > max_nodes;
        tree.first_child.push(tree.len() as u32);
        tree.open.push(is_full && !found.is_empty());
        if !is_full {
            tree.gates.extend(found.iter().map(|&(gate, _)| gate));
            place.nodes.extend(found.iter().map(|&(_, note)| (node as u32, Some(note))));
        }
        node += 1;
    }
    // The next tree begins with the empty sequence.
    place.go(0, &tree.gates, follower);
    tree.n_undecided = follower.n_undecided() - undecided_before;
    tree
}
