//! Defects of stab trees.

use super::StabParts;
use crate::CellId;

/// A defect of stab trees. In the errors of [`super::StabTrees::new`], nodes have their given numbers.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum StabError {
    /// More nodes, or gates of portals, than 32 bits count.
    #[error("{n} are more nodes or portals than stab trees can count")]
    TooMany {
        /// The number.
        n: usize,
    },
    /// Lists that do not fit each other: not one gate, one list of children and one flag for each node,
    /// or not one list of roots and one flag for each cell.
    #[error("the lists of the stab trees have {n} entries where {expected} are needed")]
    Lists {
        /// Number of entries.
        n: usize,
        /// Number of entries that fit the other lists.
        expected: usize,
    },
    /// A list that ends before it begins, or does not end where its entries do.
    #[error("list {list} of the stab trees does not lie where it must")]
    Bounds {
        /// The index among the lists of children, or of roots.
        list: usize,
    },
    /// Trees for another number of cells.
    #[error("the stab trees are of {n} cells, the table has {n_cells}")]
    Cells {
        /// Number of cells with a tree.
        n: usize,
        /// Number of cells.
        n_cells: usize,
    },
    /// A portal that does not exist.
    #[error("node {node} of the stab trees crosses portal {portal}, which does not exist")]
    Portal {
        /// The node.
        node: usize,
        /// The portal.
        portal: u32,
    },
    /// A child that does not come before its parent, so that there might be a cycle.
    #[error("node {node} of the stab trees has child {child}, which does not come before it")]
    Child {
        /// The parent.
        node: usize,
        /// The child.
        child: u32,
    },
    /// A child whose portal does not lead out of the cell that its parent's leads into.
    #[error("node {node} of the stab trees does not lead to where its child {child} begins")]
    Apart {
        /// The parent.
        node: usize,
        /// The child.
        child: u32,
    },
    /// A root that does not exist, or does not lead out of its cell.
    #[error("node {root} of the stab trees does not begin in cell {cell}")]
    Root {
        /// The cell.
        cell: CellId,
        /// The root.
        root: u32,
    },
}

/// Checks what does not depend on the portals: lists that fit each other, and children before parents.
pub(super) fn check_parts(parts: &StabParts, n_cells: usize) -> Result<(), StabError> {
    let n = parts.gates.len();
    if u32::try_from(n).is_err() {
        return Err(StabError::TooMany { n });
    }
    check_lists(&parts.first_child, parts.children.len(), n)?;
    check_lists(&parts.first_root, parts.roots.len(), parts.root_open.len())?;
    if parts.open.len() != n {
        return Err(StabError::Lists { n: parts.open.len(), expected: n });
    }
    if parts.root_open.len() != n_cells {
        return Err(StabError::Cells { n: parts.root_open.len(), n_cells });
    }
    let lists = |first: &[u32], list: usize| first[list] as usize..first[list + 1] as usize;
    for node in 0..n {
        let children = &parts.children[lists(&parts.first_child, node)];
        if let Some(&child) = children.iter().find(|&&child| child as usize >= node) {
            return Err(StabError::Child { node, child });
        }
    }
    for (i, cell) in (0..n_cells).zip((0u32..).map(CellId)) {
        let roots = &parts.roots[lists(&parts.first_root, i)];
        if let Some(&root) = roots.iter().find(|&&root| root as usize >= n) {
            return Err(StabError::Root { cell, root });
        }
    }
    Ok(())
}

/// Checks that `first` holds the begins and ends of `n` lists, which together have `n_items` entries.
fn check_lists(first: &[u32], n_items: usize, n: usize) -> Result<(), StabError> {
    if first.is_empty() && n == 0 {
        return if n_items == 0 { Ok(()) } else { Err(StabError::Bounds { list: 0 }) };
    }
    if first.len() != n + 1 {
        return Err(StabError::Lists { n: first.len(), expected: n + 1 });
    }
    if first[0] != 0 {
        return Err(StabError::Bounds { list: 0 });
    }
    match first.windows(2).position(|pair| pair[0] > pair[1]) {
        Some(list) => Err(StabError::Bounds { list }),
        None if first[n] as usize != n_items => Err(StabError::Bounds { list: n }),
        None => Ok(()),
    }
}
