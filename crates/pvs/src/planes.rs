//! Point location by a binary tree of planes in space.
//!
//! Cells of a map that was cut along planes are not their boxes: the boxes of neighbours overlap, and a viewer would be
//! found in many. The tree that cut them locates a point exactly. It is walked in plain doubles; a point so close to a
//! plane that rounding could matter goes to both sides, and is found in additional cells.

use crate::CellId;

/// What is on one side of a plane.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PlaneChild {
    /// Another plane divides it; an index into the nodes.
    Node(u32),
    /// All of it is in this cell.
    Cell(CellId),
    /// No cell is there.
    Nothing,
}

/// A plane and the children on its two sides.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PlaneNode {
    /// Normal of the plane. Of any length; distances are measured in it, see [`PlaneTree::new`].
    pub normal: [f64; 3],
    /// The plane is where `normal · p == offset`.
    pub offset: f64,
    /// First where `normal · p >= offset`, then where `normal · p <= offset`.
    pub children: [PlaneChild; 2],
}

/// A binary tree of planes over cells. Always a tree: children after their parents, no shared or unused
/// nodes. A cell may be on many leaves.
#[derive(Debug, Clone, PartialEq)]
pub struct PlaneTree {
    nodes: Vec<PlaneNode>,
    slack: f64,
}

/// A defect of a plane tree.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum PlaneError {
    /// There are no nodes, so there is no root.
    #[error("the plane tree has no root")]
    Empty,
    /// More nodes, or larger ids of cells, than a file can store.
    #[error("the plane tree counts up to {n}, more than 31 bits can")]
    TooMany {
        /// The number.
        n: usize,
    },
    /// A slack below 0, NaN or infinite.
    #[error("the slack of the plane tree is not a finite number from 0")]
    Slack,
    /// NaN or an infinity.
    #[error("plane {node} has a number that is not finite")]
    NotFinite {
        /// The node.
        node: usize,
    },
    /// A child that does not exist, or does not come after its parent.
    #[error("plane {node} has no child {child}")]
    Child {
        /// The parent.
        node: usize,
        /// The child.
        child: u32,
    },
    /// Two parents: not a tree.
    #[error("plane {node} is reached twice")]
    Shared {
        /// The node.
        node: usize,
    },
    /// A node that the root does not lead to.
    #[error("plane {node} is never reached")]
    Unreachable {
        /// The node.
        node: usize,
    },
    /// The tree is deeper than [`PlaneTree::MAX_DEPTH`].
    #[error("plane {node} is deeper than {} levels", PlaneTree::MAX_DEPTH)]
    TooDeep {
        /// The node.
        node: usize,
    },
    /// A cell that does not exist.
    #[error("plane {node} leads to cell {cell}, which does not exist")]
    UnknownCell {
        /// The node.
        node: usize,
        /// The cell.
        cell: CellId,
    },
    /// Planes in a table of the plane.
    #[error("a table of the plane has a plane tree")]
    Dimension,
}

impl PlaneTree {
    /// Longest path from the root, so that no file can make queries slow.
    pub const MAX_DEPTH: usize = 1024;
    /// Nodes and ids of cells stay below this: a file distinguishes them by one bit.
    const LIMIT: usize = 1 << 31;

    /// Checks a tree whose root is node 0. O(nodes).
    ///
    /// A point `p` with `|normal · p - offset| <= slack` goes to both sides of a plane. With normals of unit length
    /// `slack` is a distance in scene units; otherwise it is one times that length. It is for trees whose planes are
    /// known only approximately, such as rounded ones; our own rounding is accounted for in addition.
    ///
    /// # Errors
    /// [`PlaneError`] if this is no tree. Whether the cells exist is checked by [`crate::Table::new`].
    pub fn new(nodes: Vec<PlaneNode>, slack: f64) -> Result<Self, PlaneError> {
        if !(slack.is_finite() && slack >= 0.0) {
            return Err(PlaneError::Slack);
        }
        match nodes.len() {
            0 => return Err(PlaneError::Empty),
            n if n > Self::LIMIT => return Err(PlaneError::TooMany { n }),
            _ => {}
        }
        // Parents come first, so a node's depth is known when it is reached; 0 stands for "not reached".
        let mut depth = vec![0usize; nodes.len()];
        depth[0] = 1;
        for (i, PlaneNode { normal, offset, children }) in nodes.iter().enumerate() {
            if depth[i] == 0 {
                return Err(PlaneError::Unreachable { node: i });
            }
            if depth[i] > Self::MAX_DEPTH {
                return Err(PlaneError::TooDeep { node: i });
            }
            if !normal.iter().chain([offset]).all(|x| x.is_finite()) {
                return Err(PlaneError::NotFinite { node: i });
            }
            for child in children {
                match *child {
                    PlaneChild::Node(child) => match depth.get(child as usize) {
                        Some(0) if child as usize > i => depth[child as usize] = depth[i] + 1,
                        Some(_) if child as usize > i => return Err(PlaneError::Shared { node: child as usize }),
                        _ => return Err(PlaneError::Child { node: i, child }),
                    },
                    PlaneChild::Cell(cell) if cell.idx() >= Self::LIMIT => {
                        return Err(PlaneError::TooMany { n: cell.idx() });
                    }
                    PlaneChild::Cell(_) | PlaneChild::Nothing => {}
                }
            }
        }
        Ok(Self { nodes, slack })
    }

    /// The nodes, each after its parent.
    pub fn nodes(&self) -> &[PlaneNode] {
        &self.nodes
    }

    /// The distance from a plane within which a point goes to both sides; see [`PlaneTree::new`].
    pub fn slack(&self) -> f64 {
        self.slack
    }

    /// Calls `visit` with every cell that `p` (scene units) may be in; a cell is visited more than once if `p` leads to
    /// several of its leaves. `pending` is scratch space: if it is reused, nothing is allocated once it is warm. Errs
    /// towards more cells. O(depth), if `p` is near no plane.
    ///
    /// Coordinates that are not finite are near every plane.
    #[inline]
    pub fn for_each_cell(&self, p: [f64; 3], pending: &mut Vec<u32>, mut visit: impl FnMut(CellId)) {
        pending.clear();
        pending.push(0);
        while let Some(at) = pending.pop() {
            let node = &self.nodes[at as usize];
            let (above, below) = node.sides(p, self.slack);
            for (child, open) in node.children.iter().zip([above, below]) {
                match *child {
                    PlaneChild::Node(next) if open => pending.push(next),
                    PlaneChild::Cell(cell) if open => visit(cell),
                    _ => {}
                }
            }
        }
    }

    /// Calls `visit` with every cell that some point of the closed box from `min` to `max` (scene units) may be in,
    /// until it returns `false`; a cell is visited more than once if it is on several leaves. A box that contains
    /// another meets at least the same leaves, rounding included. Errs towards more cells. `pending` is scratch.
    /// O(nodes met).
    pub fn for_each_cell_of_box(
        &self,
        min: [f64; 3],
        max: [f64; 3],
        pending: &mut Vec<u32>,
        mut visit: impl FnMut(CellId) -> bool,
    ) {
        pending.clear();
        pending.push(0);
        while let Some(at) = pending.pop() {
            let node = &self.nodes[at as usize];
            let (above, below) = node.sides_of_box(min, max, self.slack);
            for (child, open) in node.children.iter().zip([above, below]) {
                match *child {
                    PlaneChild::Node(next) if open => pending.push(next),
                    PlaneChild::Cell(cell) if open && !visit(cell) => return,
                    _ => {}
                }
            }
        }
    }

    /// Checks that this is a tree over the cells of a table.
    pub(crate) fn check(&self, n_cells: usize, dimension: u8) -> Result<(), PlaneError> {
        if dimension != 3 {
            return Err(PlaneError::Dimension);
        }
        for (node, PlaneNode { children, .. }) in self.nodes.iter().enumerate() {
            for child in children {
                if let PlaneChild::Cell(cell) = *child
                    && cell.idx() >= n_cells
                {
                    return Err(PlaneError::UnknownCell { node, cell });
                }
            }
        }
        Ok(())
    }
}

impl PlaneNode {
    /// Whether `p` may be above the plane or within `slack` of it, and whether it may be below or within `slack`.
    ///
    /// Errs towards `true`, and one of the two is always `true`. Holds for all doubles: overflow makes the bound
    /// infinite or a comparison one with NaN, and both give `true`.
    ///
    /// The bound is our own. Let u = 2^-53 and m the sum of the absolute values of the three products, of
    /// the offset and of the slack. A product takes part in at most one rounding of its own and three of
    /// sums, so the height is wrong by at most ((1 + u)^4 - 1) m <= (4 u + 7 u^2) m, as long as nothing
    /// underflows. The computed m is at least (1 - u)^5 m; the sum of slack and bound loses at most u of
    /// itself, which is at most u m and u of the bound. So a bound of 8 u times the computed m is enough:
    /// 8 u (1 - u)^7 m - u m >= (4 u + 7 u^2) m. What underflows in products, also those of the bound, is
    /// a few times 2^-1075, which the smallest normal number outweighs.
    #[inline]
    fn sides(&self, p: [f64; 3], slack: f64) -> (bool, bool) {
        const RELATIVE: f64 = 4.0 * f64::EPSILON;
        let [x, y, z] = [self.normal[0] * p[0], self.normal[1] * p[1], self.normal[2] * p[2]];
        let height = ((x + y) + z) - self.offset;
        let size = (((x.abs() + y.abs()) + z.abs()) + self.offset.abs()) + slack;
        let near = slack + (RELATIVE * size + f64::MIN_POSITIVE);
        let (certainly_above, certainly_below) = (height > near, height < -near);
        (!certainly_below, !certainly_above)
    }

    /// Whether some point of a box may be above the plane or within `slack` of it, and whether one may be below or
    /// within `slack`.
    ///
    /// As [`PlaneNode::sides`] for the box's corners that are farthest above and below; these are chosen by signs, without
    /// rounding. The bound is taken for the largest magnitudes in the box, so it is enough for both, and a larger box has a
    /// larger one: with sums of monotone steps, a box that contains another is on no fewer sides.
    #[inline]
    fn sides_of_box(&self, min: [f64; 3], max: [f64; 3], slack: f64) -> (bool, bool) {
        const RELATIVE: f64 = 4.0 * f64::EPSILON;
        let up = |k: usize| self.normal[k] * if self.normal[k] >= 0.0 { max[k] } else { min[k] };
        let down = |k: usize| self.normal[k] * if self.normal[k] >= 0.0 { min[k] } else { max[k] };
        let largest = |k: usize| (self.normal[k] * min[k]).abs().max((self.normal[k] * max[k]).abs());
        let (top, bottom) = (((up(0) + up(1)) + up(2)) - self.offset, ((down(0) + down(1)) + down(2)) - self.offset);
        let size = (((largest(0) + largest(1)) + largest(2)) + self.offset.abs()) + slack;
        let near = slack + (RELATIVE * size + f64::MIN_POSITIVE);
        let (certainly_above, certainly_below) = (bottom > near, top < -near);
        (!certainly_below, !certainly_above)
    }
}
