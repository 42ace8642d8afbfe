//! The stab tree of one cell, in the numbers of its subgraph.

use crate::source::CellSource;
use sightlines_pvs::{CellId, PortalId};
use std::collections::BTreeMap;

/// No node of a stab tree.
pub(crate) const NO_NODE: u32 = u32::MAX;

/// The stab tree of one cell: an acyclic graph whose paths from the root are the sequences.
///
/// Node 0 is the root.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct LocalTrees {
    /// The way that leads into each node; anything for the root.
    ways: Vec<u32>,
    first_child: Vec<u32>,
    children: Vec<u32>,
    open: Vec<bool>,
}

impl LocalTrees {
    /// The tree of the root of a subgraph, by its id and its number, as far as it leads along edges of the subgraph; `None` if the
    /// source has no trees. `edge_through` finds the edge out of a cell through a portal, and the cell that it leads into.
    pub(crate) fn of<S: CellSource + ?Sized>(
        source: &S,
        (root_id, root): (CellId, u32),
        edge_through: impl Fn(u32, PortalId) -> Option<(u32, u32)>,
    ) -> Result<Option<Self>, S::Error> {
        let mut list = Vec::new();
        let Some(open) = source.stab_roots(root_id, &mut list)? else { return Ok(None) };
        let mut tree = Self { ways: vec![0], first_child: Vec::new(), children: Vec::new(), open: vec![open] };
        // The cell that each node leads into, and its children in the numbers of the source.
        let mut nodes: Vec<(u32, Vec<u32>)> = vec![(root, list)];
        let mut numbers: BTreeMap<u32, u32> = BTreeMap::new();
        let mut next = 0;
        while next < nodes.len() {
            tree.first_child.push(tree.children.len() as u32);
            let (cell, children) = (nodes[next].0, std::mem::take(&mut nodes[next].1));
            for child in children {
                if let Some(&number) = numbers.get(&child) {
                    tree.children.push(number);
                    continue;
                }
                let mut list = Vec::new();
                let step = source.stab_node(child, &mut list)?;
                // What leads out of the subgraph leads nowhere: by the rows it is hidden.
                let Some((way, to)) = edge_through(cell, step.portal) else { continue };
                let number = nodes.len() as u32;
                numbers.insert(child, number);
                nodes.push((to, list));
                tree.ways.push(way);
                tree.open.push(step.open);
                tree.children.push(number);
            }
            next += 1;
        }
        tree.first_child.push(tree.children.len() as u32);
        Ok(Some(tree))
    }

    pub(crate) const fn root(&self) -> u32 {
        0
    }

    pub(crate) fn n_nodes(&self) -> usize {
        self.ways.len()
    }

    /// The way that leads into a node other than the root.
    pub(crate) fn way(&self, node: u32) -> u32 {
        self.ways[node as usize]
    }

    pub(crate) fn is_open(&self, node: u32) -> bool {
        self.open[node as usize]
    }

    pub(crate) fn children_range(&self, node: u32) -> std::ops::Range<u32> {
        self.first_child[node as usize]..self.first_child[node as usize + 1]
    }

    pub(crate) fn child(&self, at: u32) -> u32 {
        self.children[at as usize]
    }

    pub(crate) fn children(&self, node: u32) -> &[u32] {
        let range = self.children_range(node);
        &self.children[range.start as usize..range.end as usize]
    }

    pub(crate) fn n_bytes(&self) -> usize {
        4 * (self.ways.capacity() + self.first_child.capacity() + self.children.capacity()) + self.open.capacity()
    }
}
