//! The tree under construction, in ranks.

use crate::ranks::{RankBox, Ranks};
use crate::region::Rect;
use crate::tree::AxialNode;
use sightlines_pvs::CellId;

/// A node in ranks; the low child of an inner node is the next node.
#[derive(Debug)]
pub(crate) enum RankNode {
    Inner {
        axis: usize,
        rank: u32,
        high: u32,
        /// What faces leave open of the plane inside the node's cell, without overlap.
        open: Vec<Rect>,
    },
    Leaf(CellId),
}

/// Nodes in preorder, and the cells of the leaves.
#[derive(Debug)]
pub(crate) struct Skeleton<const D: usize> {
    pub(crate) nodes: Vec<RankNode>,
    pub(crate) cells: Vec<RankBox<D>>,
    /// Pieces of faces left inside of cells.
    pub(crate) n_detail: usize,
}

impl<const D: usize> Skeleton<D> {
    pub(crate) const fn new() -> Self {
        Self { nodes: Vec::new(), cells: Vec::new(), n_detail: 0 }
    }

    /// The nodes in scene units.
    pub(crate) fn in_scene(&self, ranks: &Ranks<D>) -> Vec<AxialNode> {
        let node = |(low, node): (u32, &RankNode)| match *node {
            RankNode::Leaf(cell) => AxialNode::Leaf(cell),
            RankNode::Inner { axis, rank, high, .. } => {
                AxialNode::Inner { axis, at: ranks.value(axis, rank), low, high }
            }
        };
        (1u32..).zip(&self.nodes).map(node).collect()
    }
}
