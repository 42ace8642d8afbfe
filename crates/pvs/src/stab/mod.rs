//! Stab trees as a table stores them: one acyclic graph for all cells.
//!
//! A stab tree lists the sequences of portals out of a cell that have a sight line. Written out, with one node for each
//! sequence, the trees of a scene are larger than everything else in its table. But what can follow a portal is often
//! the same after different beginnings, and is then stored once: a node has the portal that is crossed, and its
//! children are the portals that may be crossed next, on every path to it. Trees of different cells share nodes as
//! parts of one tree do.

mod canon;
mod error;

pub use error::StabError;

use crate::records::PortalRecord;
use crate::{CellId, PortalId, bits};

/// Nodes and edges under construction. Nodes are numbered by [`StabParts::push_node`], from 0.
///
/// Equal nodes may be given more than once; [`StabTrees::new`] merges them.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct StabParts {
    /// For each node the gate it crosses: twice the number of a portal, and 1 more if it is crossed from
    /// its second cell into its first.
    pub gates: Vec<u32>,
    /// Where the children of each node begin in `children`; one entry more than nodes, or none without.
    pub first_child: Vec<u32>,
    /// The children of all nodes, one list after the other; each comes before its parents.
    pub children: Vec<u32>,
    /// For each node whether its tree was cut there: any sequence may follow.
    pub open: Vec<bool>,
    /// Where the roots of each cell begin in `roots`; one entry more than cells, or none without.
    pub first_root: Vec<u32>,
    /// The roots of all cells, one list after the other: the gates out of the cell.
    pub roots: Vec<u32>,
    /// For each cell whether its tree was cut at the root: any sequence may be visible from it.
    pub root_open: Vec<bool>,
}

impl StabParts {
    /// Adds a node and returns its number. `children` are numbers of existing nodes.
    ///
    /// # Panics
    /// If there are more nodes or children than 32 bits count.
    pub fn push_node(&mut self, portal: PortalId, forward: bool, children: &[u32], open: bool) -> u32 {
        let node = count(self.gates.len());
        assert!(portal.0 <= u32::MAX / 2, "portal {portal} is more than 31 bits can count");
        self.gates.push(2 * portal.0 + u32::from(!forward));
        push_list(&mut self.first_child, &mut self.children, children);
        self.open.push(open);
        node
    }

    /// Adds the tree of the next cell, starting with the first.
    ///
    /// # Panics
    /// If there are more roots than 32 bits count.
    pub fn push_cell(&mut self, roots: &[u32], open: bool) {
        push_list(&mut self.first_root, &mut self.roots, roots);
        self.root_open.push(open);
    }
}

fn push_list(first: &mut Vec<u32>, items: &mut Vec<u32>, list: &[u32]) {
    if first.is_empty() {
        first.push(0);
    }
    items.extend_from_slice(list);
    first.push(count(items.len()));
}

/// A number of items in memory, which the caller bounds.
fn count(n: usize) -> u32 {
    u32::try_from(n).expect("stab trees count with 32 bits")
}

/// The stab trees of all cells.
///
/// Always in canonical order, independent of the order of the parts: nodes by their height over the leaves, by the cell
/// that they lead into, by whether they are open, by their children, by their gate. No two nodes are equal, each is
/// reached from some root, and lists of children and of roots ascend. So two `StabTrees` with the same sequences
/// written in equal trees are equal.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct StabTrees {
    pub(crate) gates: Vec<u32>,
    /// For each node the number of the list of its children. Nodes with the same list are adjacent.
    pub(crate) after: Vec<u32>,
    /// Where the lists begin in `children`; one entry more than lists.
    pub(crate) first_child: Vec<u32>,
    pub(crate) children: Vec<u32>,
    /// For each list whether anything may follow.
    pub(crate) open: Bits,
    /// One entry more than cells.
    pub(crate) first_root: Vec<u32>,
    pub(crate) roots: Vec<u32>,
    pub(crate) root_open: Bits,
}

impl StabTrees {
    /// Checks the parts, for a table with these portals and this many cells, merges equal nodes, drops unreachable
    /// ones, and brings the rest into order: the numbers of nodes change. The children of a node become a set.
    ///
    /// O(n log n) comparisons of lists, and memory for the parts twice.
    ///
    /// # Errors
    /// [`StabError`], with the given numbers of nodes.
    pub fn new(parts: StabParts, portals: &[PortalRecord], n_cells: usize) -> Result<Self, StabError> {
        error::check_parts(&parts, n_cells)?;
        // The order depends on where gates lead, so they must lead somewhere.
        let given = Self {
            after: (0..parts.gates.len() as u32).collect(),
            gates: parts.gates,
            first_child: or_zero(parts.first_child),
            children: parts.children,
            open: parts.open.into_iter().collect(),
            first_root: or_zero(parts.first_root),
            roots: parts.roots,
            root_open: parts.root_open.into_iter().collect(),
        };
        given.check(portals, n_cells)?;
        Ok(canon::ordered(&given, portals))
    }

    /// The portal that a node crosses, and whether from its first cell into its second.
    ///
    /// # Panics
    /// If there is no such node.
    #[inline]
    pub fn gate(&self, node: u32) -> (PortalId, bool) {
        let gate = self.gates[node as usize];
        (PortalId(gate / 2), gate.is_multiple_of(2))
    }

    /// What may be crossed after a node, ascending; each number is below `node`.
    ///
    /// # Panics
    /// If there is no such node.
    #[inline]
    pub fn children(&self, node: u32) -> &[u32] {
        self.list(self.after[node as usize] as usize)
    }

    #[inline]
    pub(crate) fn list(&self, list: usize) -> &[u32] {
        &self.children[self.first_child[list] as usize..self.first_child[list + 1] as usize]
    }

    /// Whether the tree was cut at a node: any sequence may follow it.
    ///
    /// # Panics
    /// If there is no such node.
    #[inline]
    pub fn is_open(&self, node: u32) -> bool {
        self.open.get(self.after[node as usize] as usize)
    }

    /// The nodes that begin the sequences out of a cell, ascending.
    ///
    /// # Panics
    /// If there is no such cell.
    #[inline]
    pub fn roots(&self, cell: CellId) -> &[u32] {
        let k = cell.idx();
        &self.roots[self.first_root[k] as usize..self.first_root[k + 1] as usize]
    }

    /// Whether the tree of a cell was cut at the root: any sequence may be visible from it.
    ///
    /// # Panics
    /// If there is no such cell.
    #[inline]
    pub fn is_root_open(&self, cell: CellId) -> bool {
        self.root_open.get(cell.idx())
    }

    /// Number of cells.
    pub fn n_cells(&self) -> usize {
        self.root_open.len()
    }

    /// Number of nodes, those of all trees together.
    pub fn n_nodes(&self) -> usize {
        self.gates.len()
    }

    /// Number of different lists of children, which is the number stored: one for all nodes that lead into the same
    /// cell and have the same children.
    pub fn n_lists(&self) -> usize {
        self.open.len()
    }

    /// Number of children of all nodes together. O(nodes).
    pub fn n_edges(&self) -> u64 {
        (0..self.n_nodes() as u32).map(|node| self.children(node).len() as u64).sum()
    }

    /// Number of sequences in the trees of all cells, which is the number of nodes that the trees would have without
    /// sharing, roots excluded; at most `u128::MAX`. O(size).
    pub fn n_sequences(&self) -> u128 {
        // For each list, with the node that it follows. Children have earlier lists.
        let mut below = vec![1u128; self.n_lists()];
        for list in 0..self.n_lists() {
            below[list] = self.sum(self.list(list), 1, &below);
        }
        self.sum(&self.roots, 0, &below)
    }

    fn sum(&self, nodes: &[u32], start: u128, below: &[u128]) -> u128 {
        nodes.iter().fold(start, |n, &node| n.saturating_add(below[self.after[node as usize] as usize]))
    }

    /// Checks that the trees belong to a table with these portals and this many cells. O(size).
    pub(crate) fn check(&self, portals: &[PortalRecord], n_cells: usize) -> Result<(), StabError> {
        if self.n_cells() != n_cells {
            return Err(StabError::Cells { n: self.n_cells(), n_cells });
        }
        // A gate is a portal and one bit.
        if portals.len() >= 1 << 31 {
            return Err(StabError::TooMany { n: portals.len() });
        }
        for (node, &gate) in self.gates.iter().enumerate() {
            if gate as usize / 2 >= portals.len() {
                return Err(StabError::Portal { node, portal: gate / 2 });
            }
        }
        // A list is checked once, with the first node that it follows: the others lead to the same cell.
        let (mut last, mut expected) = (None, None);
        for node in 0..self.n_nodes() {
            let (list, into) = (self.after[node], ends(portals, self.gates[node])[1]);
            let children = self.list(list as usize);
            if last != Some(list) || expected != Some(into) {
                if let Some(&child) = children.iter().find(|&&c| ends(portals, self.gates[c as usize])[0] != into) {
                    return Err(StabError::Apart { node, child });
                }
                (last, expected) = (Some(list), Some(into));
            }
        }
        for cell in (0..n_cells as u32).map(CellId) {
            for &root in self.roots(cell) {
                if ends(portals, self.gates[root as usize])[0] != cell {
                    return Err(StabError::Root { cell, root });
                }
            }
        }
        Ok(())
    }
}

/// The cells that a gate leads from and into; its portal must exist.
#[inline]
pub(crate) fn ends(portals: &[PortalRecord], gate: u32) -> [CellId; 2] {
    let cells = portals[gate as usize / 2].cells;
    if gate.is_multiple_of(2) { cells } else { [cells[1], cells[0]] }
}

fn or_zero(first: Vec<u32>) -> Vec<u32> {
    if first.is_empty() { vec![0] } else { first }
}

/// Bits, 64 in a word.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub(crate) struct Bits {
    words: Vec<u64>,
    n: usize,
}

impl Bits {
    pub(crate) fn push(&mut self, on: bool) {
        if self.n.is_multiple_of(bits::WORD) {
            self.words.push(0);
        }
        self.words[self.n / bits::WORD] |= u64::from(on) << (self.n % bits::WORD);
        self.n += 1;
    }

    pub(crate) fn len(&self) -> usize {
        self.n
    }

    #[inline]
    pub(crate) fn get(&self, i: usize) -> bool {
        assert!(i < self.n, "bit {i} of {}", self.n);
        self.words[i / bits::WORD] >> (i % bits::WORD) & 1 == 1
    }
}

impl FromIterator<bool> for Bits {
    fn from_iter<T: IntoIterator<Item = bool>>(iter: T) -> Self {
        let mut bits = Self::default();
        iter.into_iter().for_each(|on| bits.push(on));
        bits
    }
}
