//! The finished subdivision: cells, portals, and which cell a point is in.

use sightlines_geometry::Aabb;
use sightlines_pvs::CellId;

/// A node of the tree.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum AxialNode {
    /// Divides its cell.
    Inner {
        /// The axis that the splitting plane is perpendicular to.
        axis: usize,
        /// Where on that axis it lies, in scene units.
        at: f64,
        /// Index of the node for smaller coordinates; it is the next node.
        low: u32,
        /// Index of the node for the others.
        high: u32,
    },
    /// A cell.
    Leaf(CellId),
}

/// A cell: a closed box of positive extent along every axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AxialCell<const D: usize> {
    /// Its extent, in scene units.
    pub bounds: Aabb<D>,
}

/// An opening between two cells, or a piece of one: the inside of an interval (`D` = 2) or rectangle (`D` = 3).
///
/// Where the opening between two cells is no rectangle, several disjoint portals make it up exactly.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AxialPortal<const D: usize> {
    /// The cells: the one at smaller coordinates of `axis`, then the other.
    pub cells: [CellId; 2],
    /// The axis that the portal is perpendicular to.
    pub axis: usize,
    /// Where on that axis it lies, in scene units.
    pub at: f64,
    /// Lower corner, in scene units; `min[axis] == at`.
    pub min: [f64; D],
    /// Upper corner, in scene units; `max[axis] == at`, and `min < max` on the other axes.
    pub max: [f64; D],
}

/// A subdivision into boxes. Made by [`subdivide`](crate::subdivide); always consistent.
#[derive(Debug, Clone, PartialEq)]
pub struct AxialTree<const D: usize> {
    pub(crate) bounds: Aabb<D>,
    pub(crate) nodes: Vec<AxialNode>,
    pub(crate) cells: Vec<AxialCell<D>>,
    pub(crate) portals: Vec<AxialPortal<D>>,
    pub(crate) n_detail: usize,
}

impl<const D: usize> AxialTree<D> {
    /// The root cell, in scene units.
    pub fn bounds(&self) -> Aabb<D> {
        self.bounds
    }

    /// All nodes in preorder, the root first.
    pub fn nodes(&self) -> &[AxialNode] {
        &self.nodes
    }

    /// All cells, by id: the leaves depth-first, low before high.
    pub fn cells(&self) -> &[AxialCell<D>] {
        &self.cells
    }

    /// All portals as exact disjoint pieces, by their cells, then by place.
    pub fn portals(&self) -> &[AxialPortal<D>] {
        &self.portals
    }

    /// Number of pieces of faces left inside of cells, which hide nothing; 0 if the threshold was 0.
    pub fn n_detail(&self) -> usize {
        self.n_detail
    }

    /// The one cell that `p`, in scene units, is assigned to; none outside the bounds or for NaN.
    ///
    /// On a splitting plane the cell above it is taken: `x < at` goes low, all else high. A viewer on a border also
    /// sees from the other side; [`Self::locate_all`] is the conservative query. O(depth).
    pub fn locate(&self, p: [f64; D]) -> Option<CellId> {
        if !self.bounds.contains(p) {
            return None;
        }
        let mut node = 0;
        loop {
            match self.nodes[node] {
                AxialNode::Leaf(cell) => return Some(cell),
                AxialNode::Inner { axis, at, low, high } => node = if p[axis] < at { low } else { high } as usize,
            }
        }
    }

    /// All closed cells that contain `p`, in scene units, ascending; up to 2^D of them.
    pub fn locate_all(&self, p: [f64; D]) -> Vec<CellId> {
        let mut found = Vec::new();
        let mut stack = if self.bounds.contains(p) { vec![0] } else { vec![] };
        while let Some(node) = stack.pop() {
            match self.nodes[node as usize] {
                AxialNode::Leaf(cell) => found.push(cell),
                AxialNode::Inner { axis, at, low, high } => {
                    if p[axis] >= at {
                        stack.push(high);
                    }
                    if p[axis] <= at {
                        stack.push(low);
                    }
                }
            }
        }
        found
    }
}
