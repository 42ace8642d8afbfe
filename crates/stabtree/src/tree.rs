//! Stab trees: every stabbable portal sequence out of a cell; of one cell, or of all cells in one graph.

mod by_polygons;
mod folded;
mod follow;
mod forest;
mod gate_graph;
mod grow;
mod share;

pub use by_polygons::ByPolygons;
pub use folded::StabTreesSummary;
pub use follow::{ByStabber, Follower, gate_of, portal_of};
pub use forest::{StabTreesOptions, stab_trees, stab_trees_axial, stab_trees_convex, stab_trees_planar};

use sightlines_cells::{CellGraph, CellId, Exit, PortalId, Space};
use sightlines_sightline::Stabber;

/// A cell reached by one sequence of portals.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct StabNode {
    /// The cell reached.
    pub cell: CellId,
    /// The portal crossed last; `None` at the root.
    pub portal: Option<PortalId>,
    /// Index of the node before the last portal; `None` at the root.
    pub parent: Option<u32>,
}

/// All sequences of portals out of a cell that an open set of lines passes, as a tree in depth-first order. A cell
/// occurs once for each sequence that reaches it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct StabTree {
    nodes: Vec<StabNode>,
}

/// A stab tree has more nodes than allowed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("the stab tree of cell {cell} has more than {max_nodes} nodes")]
pub struct TreeTooLarge {
    /// The cell at the root.
    pub cell: CellId,
    /// The limit.
    pub max_nodes: usize,
}

/// A node with exits still to try.
struct Open<U> {
    node: u32,
    /// The side through which it was entered; `None` at the root.
    entry_side: Option<u32>,
    /// Place of the next exit to try.
    next: usize,
    /// How to undo its portal; `None` if the sequence began with it.
    undo: Option<U>,
}

impl StabTree {
    /// Builds the tree of `root`; `crossing` gives an exit's portal, oriented for crossing it.
    ///
    /// Exact if the stabber is. The number of nodes can be exponential in the size of the graph, hence
    /// `max_nodes`.
    ///
    /// # Errors
    /// [`TreeTooLarge`].
    pub fn build<C: Space, S: Stabber>(
        graph: &CellGraph<C>,
        root: CellId,
        stabber: &mut S,
        crossing: impl Fn(&Exit) -> S::Portal,
        max_nodes: usize,
    ) -> Result<Self, TreeTooLarge> {
        let mut nodes = vec![StabNode { cell: root, portal: None, parent: None }];
        let mut stack = vec![Open::<S::Undo> { node: 0, entry_side: None, next: 0, undo: None }];
        while let Some(open) = stack.last_mut() {
            let Some(exit) = graph.exits(nodes[open.node as usize].cell).get(open.next) else {
                if let Some(undo) = open.undo.take() {
                    stabber.undo(undo);
                }
                stack.pop();
                continue;
            };
            open.next += 1;
            if open.entry_side == Some(exit.side) {
                continue;
            }
            let undo = if open.entry_side.is_none() {
                stabber.start(crossing(exit));
                None
            } else {
                match stabber.push(crossing(exit)) {
                    Some(undo) => Some(undo),
                    None => continue,
                }
            };
            if nodes.len() >= max_nodes {
                return Err(TreeTooLarge { cell: root, max_nodes });
            }
            let parent = Some(open.node);
            let child = nodes.len() as u32;
            nodes.push(StabNode { cell: exit.to, portal: Some(exit.portal), parent });
            stack.push(Open { node: child, entry_side: Some(exit.entry_side), next: 0, undo });
        }
        Ok(Self { nodes })
    }

    /// The nodes, root first, each after its parent.
    pub fn nodes(&self) -> &[StabNode] {
        &self.nodes
    }

    /// The cells on the tree, ascending: what the root sees.
    pub fn cells(&self) -> Vec<CellId> {
        let mut cells: Vec<CellId> = self.nodes.iter().map(|n| n.cell).collect();
        cells.sort_unstable();
        cells.dedup();
        cells
    }

    /// The portals from the root to a node, in order.
    pub fn portals_to(&self, node: usize) -> Vec<PortalId> {
        let mut at = Some(node);
        let mut portals = Vec::new();
        while let Some(n) = at.and_then(|i| self.nodes.get(i)) {
            portals.extend(n.portal);
            at = n.parent.map(|p| p as usize);
        }
        portals.reverse();
        portals
    }
}
