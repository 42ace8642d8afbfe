//! Which cells may contain a point: an axis-aligned binary tree.
//!
//! An inner node splits space at a coordinate; the split itself belongs to both halves, so a point on
//! it is looked up on both sides. A leaf lists the cells that may contain a point of its region. A
//! locator is *complete* for some boxes if every point of each box leads to a leaf that lists it;
//! [`crate::Table::new`] accepts no other.

mod build;

use crate::CellId;

/// A node of a tree under construction.
#[derive(Debug, Clone, PartialEq)]
pub enum LocatorNode {
    /// Splits its region in two. Points with `p[axis] <= split` are looked up in `low`, points with
    /// `p[axis] >= split` in `high`: on the split, in both.
    Inner {
        /// 0, 1 or 2 for x, y or z.
        axis: u8,
        /// The coordinate, in scene units; finite.
        split: f64,
        /// Index of the child with the smaller coordinates.
        low: u32,
        /// Index of the child with the larger coordinates.
        high: u32,
    },
    /// Ends the search.
    Leaf {
        /// The cells that may contain a point of the leaf's region, ascending.
        cells: Vec<CellId>,
    },
}

/// A node of a [`Locator`], which has its nodes in preorder: the low child of an inner node is the next node.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum LocatorNodeRef<'a> {
    /// As [`LocatorNode::Inner`].
    Inner {
        /// 0, 1 or 2 for x, y or z.
        axis: u8,
        /// The coordinate, in scene units; finite.
        split: f64,
        /// Position of the child with the larger coordinates.
        high: u32,
    },
    /// As [`LocatorNode::Leaf`].
    Leaf {
        /// The cells that may contain a point of the leaf's region, ascending.
        cells: &'a [CellId],
    },
}

/// An axis-aligned binary tree over cells. Always a tree: no cycles, no shared or unused nodes.
#[derive(Debug, Clone, PartialEq)]
pub struct Locator {
    /// In preorder: the low child of an inner node is the next node.
    nodes: Vec<Node>,
    /// The lists of all leaves, one after the other.
    cells: Vec<CellId>,
}

/// A node in preorder.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Node {
    Inner { axis: u8, split: f64, high: u32 },
    Leaf { start: u32, end: u32 },
}

/// A defect of a locator. Nodes are numbered in preorder, except in the variants of [`Locator::from_nodes`], where they
/// have the given numbers.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum LocatorError {
    /// There are no nodes, so there is no root.
    #[error("the locator has no root")]
    Empty,
    /// More nodes or leaf entries than 32 bits count.
    #[error("the locator has {n} entries, more than 32 bits can count")]
    TooMany {
        /// The number of entries.
        n: usize,
    },
    /// A child that does not exist, or, in a file, one out of order.
    #[error("locator node {node} has no child {child}")]
    Child {
        /// The parent.
        node: usize,
        /// The child.
        child: u32,
    },
    /// Two parents, or the root as a child: not a tree.
    #[error("locator node {node} is reached twice")]
    Shared {
        /// The node.
        node: usize,
    },
    /// A node that the root does not lead to.
    #[error("locator node {node} is never reached")]
    Unreachable {
        /// The node.
        node: usize,
    },
    /// A path longer than [`Locator::MAX_DEPTH`]; [`Locator::build`] never makes one.
    #[error("locator node {node} is more than {} steps below the root", Locator::MAX_DEPTH)]
    TooDeep {
        /// The first such node.
        node: usize,
    },
    /// An axis that the scene does not have.
    #[error("locator node {node} splits axis {axis}")]
    Axis {
        /// The node.
        node: usize,
        /// The axis.
        axis: u8,
    },
    /// A split at NaN or infinity.
    #[error("locator node {node} splits at no finite number")]
    Split {
        /// The node.
        node: usize,
    },
    /// The cells of a leaf are not ascending.
    #[error("the cells of locator node {node} are not ascending")]
    Order {
        /// The leaf.
        node: usize,
    },
    /// A leaf lists a cell that the table does not have.
    #[error("locator node {node} lists cell {cell}, which does not exist")]
    UnknownCell {
        /// The leaf.
        node: usize,
        /// The cell.
        cell: CellId,
    },
    /// A leaf does not list a cell whose box meets its region: points would not be found.
    #[error("locator node {node} misses cell {cell}")]
    Misses {
        /// The leaf.
        node: usize,
        /// The cell.
        cell: CellId,
    },
}

impl Default for Locator {
    /// One leaf without cells.
    fn default() -> Self {
        Self { nodes: vec![Node::Leaf { start: 0, end: 0 }], cells: Vec::new() }
    }
}

impl Locator {
    /// Longest path from the root, so that no file can make a table slow to check.
    pub const MAX_DEPTH: usize = 1024;

    /// Makes a locator from the nodes of a tree that exists already, such as a k-d tree; the root is
    /// node 0, the order of the others is free. O(nodes + cells).
    ///
    /// A k-d tree whose leaves are the cells needs to list in each leaf its own cell only.
    ///
    /// # Errors
    /// [`LocatorError`] if this is no tree. Whether it is complete is checked by [`crate::Table::new`].
    pub fn from_nodes(nodes: &[LocatorNode]) -> Result<Self, LocatorError> {
        let mut out = Self { nodes: Vec::with_capacity(nodes.len()), cells: Vec::new() };
        let mut seen = vec![false; nodes.len()];
        if nodes.is_empty() {
            return Err(LocatorError::Empty);
        }
        // Nodes to visit, each with the index of the written node that needs the index of its high child.
        let mut pending: Vec<(usize, Option<usize>)> = vec![(0, None)];
        while let Some((i, parent)) = pending.pop() {
            if std::mem::replace(&mut seen[i], true) {
                return Err(LocatorError::Shared { node: i });
            }
            let at = out.nodes.len();
            if let Some(Node::Inner { high, .. }) = parent.map(|p| &mut out.nodes[p]) {
                *high = count(at)?;
            }
            if let Some([low, high]) = out.push(i, &nodes[i])? {
                let child = |child: u32| match child as usize {
                    c if c < nodes.len() => Ok(c),
                    _ => Err(LocatorError::Child { node: i, child }),
                };
                pending.push((child(high)?, Some(at)));
                pending.push((child(low)?, None));
            }
        }
        match seen.iter().position(|&s| !s) {
            Some(node) => Err(LocatorError::Unreachable { node }),
            None => Self::from_raw(out.nodes, out.cells),
        }
    }

    /// Writes one node, checked by itself; returns its children.
    fn push(&mut self, i: usize, node: &LocatorNode) -> Result<Option<[u32; 2]>, LocatorError> {
        match node {
            LocatorNode::Inner { axis, split, low, high } => {
                self.nodes.push(Node::Inner { axis: *axis, split: *split, high: 0 });
                check_inner(i, *axis, *split)?;
                Ok(Some([*low, *high]))
            }
            LocatorNode::Leaf { cells } => {
                check_order(i, cells)?;
                let start = count(self.cells.len())?;
                self.cells.extend_from_slice(cells);
                self.nodes.push(Node::Leaf { start, end: count(self.cells.len())? });
                Ok(None)
            }
        }
    }

    /// The tree as nodes, the root first, children after their parents.
    pub fn to_nodes(&self) -> Vec<LocatorNode> {
        let node = |(i, node): (usize, &Node)| match *node {
            Node::Inner { axis, split, high } => LocatorNode::Inner { axis, split, low: i as u32 + 1, high },
            Node::Leaf { start, end } => LocatorNode::Leaf { cells: self.list(start, end).to_vec() },
        };
        self.nodes.iter().enumerate().map(node).collect()
    }

    /// A node by its position in [`Locator::to_nodes`], without a copy of its cells; `None` past the last. O(1).
    pub fn node(&self, i: usize) -> Option<LocatorNodeRef<'_>> {
        Some(match *self.nodes.get(i)? {
            Node::Inner { axis, split, high } => LocatorNodeRef::Inner { axis, split, high },
            Node::Leaf { start, end } => LocatorNodeRef::Leaf { cells: self.list(start, end) },
        })
    }

    /// Number of nodes.
    pub fn n_nodes(&self) -> usize {
        self.nodes.len()
    }

    /// Number of entries in the lists of all leaves.
    pub fn n_entries(&self) -> usize {
        self.cells.len()
    }

    /// Calls `visit` with every cell listed in a leaf whose closed region contains `p`; a cell is visited more than
    /// once if `p` lies on a split. O(depth), if `p` lies on no split.
    #[inline]
    pub fn for_each_candidate(&self, p: [f64; 3], visit: impl FnMut(CellId)) {
        self.for_each_candidate_in(p, &mut Vec::new(), visit);
    }

    /// As [`Locator::for_each_candidate`], with scratch space: allocates nothing once that is warm.
    #[inline]
    pub fn for_each_candidate_in(&self, p: [f64; 3], pending: &mut Vec<u32>, mut visit: impl FnMut(CellId)) {
        pending.clear();
        let mut at = 0;
        loop {
            match self.nodes[at] {
                Node::Inner { axis, split, high } => {
                    let x = p[usize::from(axis)];
                    match x.partial_cmp(&split) {
                        Some(std::cmp::Ordering::Less) => at += 1,
                        Some(std::cmp::Ordering::Greater) => at = high as usize,
                        _ => {
                            pending.push(high);
                            at += 1;
                        }
                    }
                }
                Node::Leaf { start, end } => {
                    self.list(start, end).iter().copied().for_each(&mut visit);
                    match pending.pop() {
                        Some(next) => at = next as usize,
                        None => return,
                    }
                }
            }
        }
    }

    /// Calls `visit` with every cell listed in a leaf whose closed region meets the closed box from `min` to `max`
    /// (scene units), until it returns `false`; a cell is visited once for each leaf that lists it. If the locator is
    /// complete for the box of a cell, and that box shares a point with this one, the cell is visited: that point leads
    /// to such a leaf. A NaN bounds nothing. `pending` is scratch space. O(nodes met).
    #[inline]
    pub fn for_each_candidate_of_box(
        &self,
        min: [f64; 3],
        max: [f64; 3],
        pending: &mut Vec<u32>,
        mut visit: impl FnMut(CellId) -> bool,
    ) {
        pending.clear();
        pending.push(0);
        while let Some(at) = pending.pop() {
            match self.nodes[at as usize] {
                Node::Inner { axis, split, high } => {
                    let axis = usize::from(axis);
                    let (above, below) = (min[axis] > split, max[axis] < split);
                    if !below {
                        pending.push(high);
                    }
                    if !above {
                        pending.push(at + 1);
                    }
                }
                Node::Leaf { start, end } => {
                    if !self.list(start, end).iter().all(|&cell| visit(cell)) {
                        return;
                    }
                }
            }
        }
    }

    fn list(&self, start: u32, end: u32) -> &[CellId] {
        &self.cells[start as usize..end as usize]
    }

    pub(crate) fn raw(&self) -> (&[Node], &[CellId]) {
        (&self.nodes, &self.cells)
    }

    /// Checks nodes that claim to be in preorder, with leaves that use `cells` one after the other.
    pub(crate) fn from_raw(nodes: Vec<Node>, cells: Vec<CellId>) -> Result<Self, LocatorError> {
        // Inner nodes whose high child is still to come, with that child and its depth.
        let mut highs: Vec<(usize, u32, usize)> = Vec::new();
        let last = nodes.len().checked_sub(1).ok_or(LocatorError::Empty)?;
        let (mut listed, mut depth) = (0, 0);
        for (i, node) in nodes.iter().enumerate() {
            match *node {
                Node::Inner { axis, split, high } => {
                    check_inner(i, axis, split)?;
                    depth += 1;
                    highs.push((i, high, depth));
                    if depth > Self::MAX_DEPTH {
                        return Err(LocatorError::TooDeep { node: i + 1 });
                    }
                }
                Node::Leaf { start, end } => {
                    // A subtree ends here: next comes the high child of the innermost waiting node.
                    let list = cells.get(start as usize..end as usize).filter(|_| start == listed);
                    check_order(i, list.ok_or(LocatorError::Order { node: i })?)?;
                    listed = end;
                    match highs.pop() {
                        Some((node, child, _)) if i == last || child as usize != i + 1 => {
                            return Err(LocatorError::Child { node, child });
                        }
                        Some((_, _, below)) => depth = below,
                        None if i != last => return Err(LocatorError::Unreachable { node: i + 1 }),
                        None => {}
                    }
                }
            }
        }
        match highs.pop() {
            Some((node, child, _)) => Err(LocatorError::Child { node, child }),
            None if listed as usize != cells.len() => Err(LocatorError::Order { node: last }),
            None => Ok(Self { nodes, cells }),
        }
    }

    /// Checks that this is a complete locator for boxes in `dimension` coordinates. O(entries * depth).
    ///
    /// A box that ends at a split is searched for only below the split, one that begins there only above: its points on
    /// the split lead to both. A box of no extent, on the split, is searched for below.
    pub(crate) fn check(&self, bounds: &[([f64; 3], [f64; 3])], dimension: u8) -> Result<(), LocatorError> {
        for (node, n) in self.nodes.iter().enumerate() {
            match *n {
                Node::Inner { axis, .. } if axis >= dimension => return Err(LocatorError::Axis { node, axis }),
                Node::Leaf { start, end } => {
                    let unknown = self.list(start, end).iter().find(|cell| cell.idx() >= bounds.len());
                    unknown.map_or(Ok(()), |&cell| Err(LocatorError::UnknownCell { node, cell }))?;
                }
                Node::Inner { .. } => {}
            }
        }
        let mut cells = (0u32..).map(CellId).zip(bounds);
        cells.try_for_each(|(cell, (min, max))| self.check_cell(cell, min, max))
    }

    fn check_cell(&self, cell: CellId, min: &[f64; 3], max: &[f64; 3]) -> Result<(), LocatorError> {
        let mut pending = vec![0];
        while let Some(node) = pending.pop() {
            match self.nodes[node] {
                Node::Inner { axis, split, high } => {
                    let axis = usize::from(axis);
                    if goes_high(max[axis], split) {
                        pending.push(high as usize);
                    }
                    if goes_low(min[axis], max[axis], split) {
                        pending.push(node + 1);
                    }
                }
                Node::Leaf { start, end } if self.list(start, end).binary_search(&cell).is_err() => {
                    return Err(LocatorError::Misses { node, cell });
                }
                Node::Leaf { .. } => {}
            }
        }
        Ok(())
    }
}

/// Whether a box from `min` to `max` has points below the split, or only points on it.
#[inline]
fn goes_low(min: f64, max: f64, split: f64) -> bool {
    min < split || max <= split
}

/// Whether a box up to `max` has points above the split. With [`goes_low`], each box goes somewhere.
#[inline]
fn goes_high(max: f64, split: f64) -> bool {
    let ends_below = max <= split;
    !ends_below
}

fn check_inner(node: usize, axis: u8, split: f64) -> Result<(), LocatorError> {
    match (axis, split.is_finite()) {
        (0..=2, true) => Ok(()),
        (0..=2, false) => Err(LocatorError::Split { node }),
        _ => Err(LocatorError::Axis { node, axis }),
    }
}

fn check_order(node: usize, cells: &[CellId]) -> Result<(), LocatorError> {
    if cells.is_sorted_by(|a, b| a < b) { Ok(()) } else { Err(LocatorError::Order { node }) }
}

fn count(n: usize) -> Result<u32, LocatorError> {
    u32::try_from(n).map_err(|_| LocatorError::TooMany { n })
}

#[cfg(test)]
mod tests;
